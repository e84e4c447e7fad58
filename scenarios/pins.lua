-- A plate with two pins over a block with two holes (dissertation figures 8.1 and 8.2): do the parts go together, and
-- does the method invent energy where the pins' wishes conflict?
--   verisim run scenarios/pins.lua --set kind=angled
local p = params{
  kind = "fitting",         -- "fitting"; "angled": the pins lean towards each other; "spaced": further apart than the
                            -- holes; "single": a plate with one pin, over the same block
  lean = deg(15),           -- rad, of each pin, for "angled"; below 0 they lean apart
  spread = mm(30),          -- m, by which the pins are further apart than the holes, for "spaced"
  clearance = mm(2),        -- m, on the radius
  voxelsize = mm(3),        -- m
  error = mm(1),            -- m, how far the hand misjudges the place, in a direction drawn from the seed
  tremor = mm(0.2),         -- m rms
  hybrid = "restore",
  integrator = "semi-implicit",
  passive = true,           -- contacts that the method changed give no more energy than they were given
  duration = 4,             -- s
}

local radius, length, apart, height = mm(25), mm(90), mm(120), mm(60)
for word, range in pairs{lean = {-deg(45), deg(45)}, clearance = {0, radius / 2}} do
  if not (p[word] >= range[1] and p[word] <= range[2]) then
    error(string.format("%s is %g; it lies between %g and %g", word, p[word], range[1], range[2]))
  end
end
defineSimulationParameters{
  maxStiffness = 300, maxAngularStiffness = 0.5, hybrid = p.hybrid, integrator = p.integrator, duration = p.duration,
  passiveContacts = p.passive,
}

local holes = Solid.cylinder{radius = radius, height = height}
addObject{
  name = "block", fixed = true, density = 20, voxelsize = p.voxelsize,
  Solid.box{mm(260), mm(120), height} - holes:translate{-apart / 2, 0, 0} - holes:translate{apart / 2, 0, 0},
}

local plate_height = mm(20)
local function pin(side)
  local leaning = p.kind == "angled" and p.lean or 0
  local spread = p.kind == "spaced" and p.spread or 0
  local shaft = Solid.cylinder{radius = radius - p.clearance, height = length}
  return shaft:translate{0, 0, -length / 2}:rotate(AngleAxis(side * leaning, Axis{0, 1, 0}))
    :translate{side * (apart + spread) / 2, 0, 0}
end
local solids = {
  fitting = function() return pin(-1) + pin(1) end, angled = function() return pin(-1) + pin(1) end,
  spaced = function() return pin(-1) + pin(1) end, single = function() return pin(1) end,
}
if not solids[p.kind] then error("kind is '" .. p.kind .. "'; it is one of fitting, angled, spaced, single") end

local up = height / 2 + length + mm(10)       -- of the plate's lower face: pins' ends 10 mm above the block
local seated = height / 2 + mm(1)
local angle = 2 * math.pi * math.random()
local beside = {p.error * math.cos(angle), p.error * math.sin(angle), 0}
local plate = addObject{
  name = "plate", density = 20, voxelsize = p.voxelsize, position = {beside[1], beside[2], up},
  Solid.box{mm(260), mm(120), plate_height}:translate{0, 0, plate_height / 2} + solids[p.kind](),
}
local hand = Devices.Hand{
  name = "hand", error = beside, tremor = p.tremor, angularTremor = deg(0.2), lead = 0.03,
  path = {{position = {0, 0, up}, dwell = 0.1}, {position = {0, 0, seated}, speed = 0.08, dwell = p.duration}},
}
addDevice(hand)
grasp(hand, plate)

local deepest = 0
Actions.addFrameAction(function()
  while true do
    deepest = math.max(deepest, height / 2 + length - plate.position[3])
    measure("depth", deepest, "m")
    outcome(deepest > 0.9 * length and "assembled" or "not assembled")
    Actions.waitForRedraw()
  end
end)
