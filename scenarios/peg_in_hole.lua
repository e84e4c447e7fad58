-- The dissertation's trial (section 8.5): an operator pushes a pin through a block and pulls it back, again and again,
-- through a Phantom Omni whose motion is scaled by 4. Pin radius 70 mm in a hole of 75 mm, block 200 mm, pin 400 mm,
-- voxels of 4.5 mm, 45.8 s. `half=true` gives the sizes of the published script instead (block 100 mm, pin 200 mm).
--
-- `strategy` other than "path": the operator seeks the hole by what it sees, misjudged by `approach` to a side that the
-- seed draws, and pushes with 3 N at most. 20 mm beside a hole of 2 mm of clearance (`--set approach=0.02 --set
-- clearance=0.002 --set hybrid=exact`), 30 seeds: passed within 45.8 s, and time of the first pass (least, quartiles, most):
--   straight   2 of 30   20.8 and 25.9 s
--   tilt      30 of 30   5.0  5.2  8.1  11.1  12.5 s
--   spiral    30 of 30   7.3  8.1  8.9   9.7  11.5 s
local p = params{
  clearance = parameter(0.005, "m", "between pin and hole, on the radius"),
  voxelsize = parameter(0.0045, "m", "of block and pin"),
  approach = parameter(0.003, "m", "how far the operator misjudges the hole's place, sideways"),
  tilt = parameter(deg(1), "rad", "how far the operator misjudges its direction"),
  tremor = parameter(0.0005, "m", "rms, at the hand"),
  duration = parameter(45.833, "s", "of the trial"),
  half = parameter(false, "", "the sizes of the published script"),
  strategy = parameter("path", "", "or straight, tilt, spiral: the operator seeks the hole by what it sees"),
  hybrid = parameter("restore", "", "the dissertation's method; off, blend, exact"),
  contact = parameter("voxmap", "", "or fcl: triangle against triangle, to compare with"),
  integrator = parameter("semi-implicit", "", "or implicit"),
  timestep = parameter(0.001, "s", "of a frame"),
  spacing = parameter(0, "m", "of the points that are tested; 0: one per surface voxel"),
  alignment = parameter("by-type", "", "or faas, pavlik: how well two faces match"),
}

local hole = 0.075
local size = p.half and 0.5 or 1
local block_height, pin_length = 0.2 * size, 0.4 * size
local scale = 4

defineSimulationParameters{
  -- A pin that is tilted on purpose needs a coupling that turns it against what it is pressed on.
  maxStiffness = 300, maxAngularStiffness = p.strategy == "path" and 0.1 or 5,
  hybrid = p.hybrid, contact = p.contact, integrator = p.integrator, alignment = p.alignment, timestep = p.timestep,
  duration = p.duration,
}
local spacing = p.spacing > 0 and p.spacing or nil

addObject{
  name = "block", fixed = true, density = 10, voxelsize = p.voxelsize, pointspacing = spacing,
  Solid.box{0.375, 0.375, block_height} - Solid.cylinder{radius = hole, height = block_height},
}

local up = block_height / 2 + 0.05 + pin_length / 2          -- pin's centre while its end is 50 mm above the block
local through = -block_height / 2 - 0.03 + pin_length / 2    -- while its end is 30 mm below
local pin = addObject{
  name = "pin", density = 10, voxelsize = p.voxelsize, pointspacing = spacing, position = {0, 0, up},
  Solid.cylinder{radius = hole - p.clearance, height = pin_length},
}

local way = {
  ["repeat"] = true,
  path = {
    {position = {0, 0, up / scale}, dwell = 0.2},
    {position = {0, 0, through / scale}, speed = 0.09, dwell = 0.1},
  },
  error = {p.approach / scale, 0, 0}, angularError = {0, p.tilt, 0},
  lead = 0.02, patience = 1.5,
}
if p.strategy ~= "path" then
  local side = 2 * math.pi * math.random()
  way = {
    loop = true, watch = "body", start = {0, 0, up / scale}, greatestForce = 3,  -- N: what the Omni can answer
    goals = {
      {goal = "insert", strategy = p.strategy, from = {0, 0, up}, to = {position = {0, 0, through}, orientation = AngleAxis(0, Axis{0, 0, 1})},
       tip = pin_length / 2, press = 1.5, pitch = 1.6 * p.clearance, searchRadius = 1.5 * p.approach, searchSpeed = 0.05, tolerance = 0.002, speed = 0.2, giveUp = p.duration},
      {goal = "withdraw", to = {0, 0, up}, tolerance = 0.005, speed = 0.2},
    },
    error = {p.approach * math.cos(side), p.approach * math.sin(side), 0}, angularError = {0, p.tilt, 0},
  }
end
way.name, way.tremor, way.angularTremor = "operator", p.tremor, 0.2 * math.abs(p.tilt)

local omni = Devices.Sensable.PhantomOmni{ name = "omni", scale = scale, forces = true, operator = Devices.Hand(way) }
addDevice(omni)
grasp(omni, pin)

-- A pass: the pin's end came from above the block to below it.
local passes, deepest, above = 0, 0, true
Actions.addFrameAction(function()
  while true do
    local bottom = pin.position[3] - pin_length / 2
    deepest = math.max(deepest, block_height / 2 - bottom)
    if bottom > block_height / 2 then above = true end
    if above and bottom < -block_height / 2 then
      above, passes = false, passes + 1
      if passes == 1 and p.strategy ~= "path" then measure("first pass", simulation.time, "s") end
      event("passed", string.format("pin is through for the %d. time", passes))
    end
    measure("passes", passes, "1")
    measure("depth", deepest, "m")
    outcome(passes > 0 and "inserted" or "not inserted")
    Actions.waitForRedraw()
  end
end)
