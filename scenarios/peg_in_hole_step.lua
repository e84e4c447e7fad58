-- The pin and the block of peg_in_hole.lua from a CAD file: models/peg_in_hole.step, written by models/make_models.cpp.
-- The operator holds the pin directly, without a device between.
local p = params{
  model = "models/peg_in_hole.step",
  voxelsize = 0.0045,       -- m
  approach = 0.002,         -- m, how far the operator misjudges the hole's place, sideways
  tremor = 0.0005,          -- m rms
  duration = 10,            -- s
  hybrid = "off",
  integrator = "semi-implicit",
}

defineSimulationParameters{
  maxStiffness = 300, maxAngularStiffness = 0.1,
  hybrid = p.hybrid, integrator = p.integrator, duration = p.duration,
}

addObject{name = "block", fixed = true, density = 10, voxelsize = p.voxelsize, Model{p.model, part = 1}}
local up, through = 0.36, 0.06   -- the pin's centre with its end 60 mm above the block, and 40 mm below it
local pin = addObject{
  name = "pin", density = 10, voxelsize = p.voxelsize, position = {0, 0, up}, Model{p.model, part = 2},
}

local hand = Devices.Hand{
  name = "hand", ["repeat"] = true,
  path = {
    {position = {0, 0, up}, dwell = 0.2},
    {position = {0, 0, through}, speed = 0.3, dwell = 0.1},
  },
  error = {p.approach, 0, 0}, tremor = p.tremor, lead = 0.05, patience = 1.5,
}
addDevice(hand)
grasp(hand, pin)

local passes, above = 0, true
Actions.addFrameAction(function()
  while true do
    local bottom = pin.position[3] - 0.2
    if bottom > 0.1 then above = true end
    if above and bottom < -0.1 then above, passes = false, passes + 1 end
    measure("passes", passes, "1")
    outcome(passes > 0 and "inserted" or "not inserted")
    Actions.waitForRedraw()
  end
end)
