-- A pin of an ISO 286 fit is pushed into its hole by a hand that misjudges place and direction: what clearances of a
-- hundredth of a millimetre feel like, and what interference does not allow.
--   verisim run scenarios/iso_fit.lua --set nominal=mm(25) --set fit=H7/g6 --set size=tightest --seed 7
local p = params{
  nominal = mm(25),         -- m, 3 to 120 mm
  fit = "H7/g6",
  size = "mid",             -- "loosest", "mid", "tightest": where in their tolerances both parts are
  chamfer = mm(1),          -- m x 45 degrees, at the hole's mouth; 0: a sharp rim, which the hand feels its way along
  error = mm(0.7),          -- m, how far the pin's tip comes down beside the hole, in a direction drawn from the seed
  tilt = deg(1),            -- rad, how far the pin is tilted, likewise
  tremor = mm(0.05),        -- m rms, 0.1 mm at most
  speed = 0.03,             -- m/s
  density = 7800,           -- kg/m^3
  hybrid = "exact",
  duration = 0,             -- s; 0: as long as the hand needs
}

local limits = require "iso286"
local hole_low, hole_high, shaft_low, shaft_high = limits(p.fit, p.nominal)
local share = ({loosest = 1, mid = 0.5, tightest = 0})[p.size]
if not share then error("size is '" .. p.size .. "'; it is one of loosest, mid, tightest") end
for word, most in pairs{chamfer = p.nominal / 2, error = p.nominal / 2, tilt = deg(20), tremor = mm(0.1)} do
  if not (p[word] >= 0 and p[word] <= most) then
    error(string.format("%s is %g; for this nominal it lies between 0 and %g", word, p[word], most))
  end
end
if not (p.speed > 0) then error(string.format("speed is %g; it must be above 0", p.speed)) end
local hole = (p.nominal + hole_low + share * (hole_high - hole_low)) / 2      -- radius
local shaft = (p.nominal + shaft_high - share * (shaft_high - shaft_low)) / 2  -- radius
local height, length = 1.5 * p.nominal, 2 * p.nominal
local voxelsize = math.min(mm(4.5), p.nominal / 5)

-- How firmly the hand holds the pin's direction [N m/rad]. With a lead the parts put each other straight in a loose hand;
-- without one it is firm enough that 2 N at the pin's rim turn it by half of the tilt only.
local grip = 2
if p.chamfer <= 0 then grip = math.max(grip, 1.4 * 4 * shaft / math.max(p.tilt, deg(0.5))) end

defineSimulationParameters{
  hybrid = p.hybrid, integrator = "implicit", duration = p.duration ~= 0 and p.duration or nil,
  maxStiffness = 2000, maxAngularStiffness = 2.5 * grip, maxCouplingForce = 35, maxCouplingTorque = 3,
}

local bore = Solid.cylinder{radius = hole, height = height}
if p.chamfer > 0 then
  local lead = Solid.cone{radius1 = hole, radius2 = hole + p.chamfer, height = p.chamfer}
  bore = bore + lead:translate{0, 0, (height - p.chamfer) / 2}
end
addObject{
  name = "block", fixed = true, density = p.density, voxelsize = voxelsize,
  Solid.box{3 * p.nominal, 3 * p.nominal, height} - bore,
}
local over = mm(3)                       -- of the tip above the block, at the start
local up = height / 2 + over + length / 2

-- The hand holds the pin in its middle; the tip's centre is to be `error` beside the axis, the pin tilted by `tilt`.
local function direction()
  local angle = 2 * math.pi * math.random()
  return math.cos(angle), math.sin(angle)
end
local ex, ey = direction()
local ax, ay = direction()
local half = length / 2
-- The tilt about (ax, ay, 0) takes the tip from (0, 0, -half) to half (-ay sin, ax sin, -cos).
local error_of_middle = {
  p.error * ex + half * ay * math.sin(p.tilt), p.error * ey - half * ax * math.sin(p.tilt),
  half * (math.cos(p.tilt) - 1),
}
local pin = addObject{
  name = "pin", density = p.density, voxelsize = voxelsize,
  position = {error_of_middle[1], error_of_middle[2], up + error_of_middle[3]},
  orientation = AngleAxis(p.tilt, Axis{ax, ay, 0}),
  Solid.cylinder{radius = shaft, height = length},
}

local path = {{position = {0, 0, up}, dwell = 0.1}}
local rim = height / 2 + length / 2
if p.chamfer <= 0 then
  -- Without a lead the hand winds outwards, as fast as pin and hand can follow, until the pin drops in. It presses with
  -- half of what would turn the pin upright: tilted it is caught by its lower edge and finds the rest of the way; flat
  -- on the block it would have to meet the hole to a hundredth of a millimetre.
  local points, most = 24, p.error + 0.5 * half * p.tilt + mm(0.5)  -- upright by half its tilt the tip is shifted, too
  local turns = math.ceil(most / mm(0.2))
  local stiffness = 1 / (1 / 400 + 1 / 2000)  -- N/m, of hand and coupling
  local press = 0.5 * grip / 1.4 * p.tilt / shaft / stiffness
  local pace = 0.5 * math.sqrt(stiffness / (p.density * math.pi * shaft ^ 2 * length))  -- rad/s
  local z = rim + shaft * math.sin(p.tilt) - press
  for i = 0, points * turns do
    local angle = 2 * math.pi * i / points
    local r = most * i / (points * turns)
    path[#path + 1] = {position = {r * math.cos(angle), r * math.sin(angle), z},
                       speed = i == 0 and p.speed or math.min(p.speed, pace * r)}
  end
end
path[#path + 1] = {position = {0, 0, length / 2 - height / 2 - mm(1)}, speed = p.speed, dwell = 0.3}

local hand = Devices.Hand{
  name = "hand", path = path, error = error_of_middle, angularError = {p.tilt * ax, p.tilt * ay, 0},
  tremor = p.tremor, lead = 0.025, angularStiffness = grip,
}
addDevice(hand)
grasp(hand, pin)

local deepest = 0
Actions.addFrameAction(function()
  while true do
    deepest = math.max(deepest, height / 2 - (pin.position[3] - half))
    measure("depth", deepest, "m")
    measure("clearance", hole - shaft, "m")
    outcome(deepest > 0.98 * height and "inserted" or "not inserted")
    Actions.waitForRedraw()
  end
end)
