-- Round things in their seats: a taper in a tapered hole, a ball in a tube, a ball in a ball socket. A hand brings each
-- into its seat, then turns or slides it where the seat leaves it free.
--   verisim run scenarios/seats.lua --set kind=ball
local p = params{
  kind = "cone",            -- "cone", "ball" (in a tube), "socket"
  clearance = mm(1),        -- m, on the radius (ball and socket)
  voxelsize = mm(2),        -- m
  hybrid = "restore",
  integrator = "semi-implicit",
  duration = 3,             -- s
}

defineSimulationParameters{
  maxStiffness = 300, maxAngularStiffness = 0.5, hybrid = p.hybrid, integrator = p.integrator, duration = p.duration,
}

local height, radius = mm(60), mm(30)
if not (p.clearance >= 0 and p.clearance <= radius / 2) then
  error(string.format("clearance is %g; it lies between 0 and %g", p.clearance, radius / 2))
end
local kinds = {
  cone = {
    seat = Solid.box{mm(120), mm(120), height} - Solid.cone{radius1 = mm(15), radius2 = mm(35), height = height},
    thing = Solid.cone{radius1 = mm(15), radius2 = mm(35), height = height}, from = mm(15), to = -mm(2), turn = deg(20),
  },
  ball = {
    seat = Solid.tube{outer = radius + mm(15), inner = radius, height = 2 * height},
    thing = Solid.sphere{radius = radius - p.clearance}, from = height + radius, to = -height / 2, turn = deg(20),
  },
  socket = {
    seat = Solid.box{mm(120), mm(120), height} - Solid.sphere{radius = radius}:translate{0, 0, height / 2},
    thing = Solid.sphere{radius = radius - p.clearance}, from = height / 2 + mm(20), to = height / 2 - mm(1),
    turn = deg(20),
  },
}
local kind = kinds[p.kind]
if not kind then error("kind is '" .. p.kind .. "'; it is one of cone, ball, socket") end

addObject{name = "seat", fixed = true, density = 20, voxelsize = p.voxelsize, kind.seat}
local thing = addObject{
  name = "thing", density = 20, voxelsize = p.voxelsize, position = {mm(1), 0, kind.from}, kind.thing,
}
local turned = AngleAxis(kind.turn, Axis{0, 0, 1})
local hand = Devices.Hand{
  name = "hand", error = {mm(1), 0, 0}, tremor = mm(0.2), lead = 0.02,
  path = {
    {position = {0, 0, kind.from}, dwell = 0.1},
    {position = {0, 0, kind.to}, speed = 0.1, dwell = 0.2},
    {position = {0, 0, kind.to}, orientation = turned, speed = 0.1, dwell = 0.5},
  },
}
addDevice(hand)
grasp(hand, thing)

local lowest = math.huge
Actions.addFrameAction(function()
  while true do
    lowest = math.min(lowest, thing.position[3])
    measure("height", lowest, "m")
    outcome(lowest < kind.to + mm(6) and "seated" or "not seated")
    Actions.waitForRedraw()
  end
end)
