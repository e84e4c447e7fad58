-- A slider pushed down on a plate and drawn across it: plane on plane. What a voxel method makes of a smooth surface is
-- seen in the sideways force and in the roughness of the height.
local p = params{
  voxelsize = 0.003,        -- m
  press = 0.004,            -- m, how far below the plate's surface the hand aims: the coupling presses with its spring
  speed = 0.1,              -- m/s
  hybrid = "off",
  integrator = "semi-implicit",
}

defineSimulationParameters{maxStiffness = 300, maxAngularStiffness = 0.5, hybrid = p.hybrid, integrator = p.integrator}

addObject{name = "plate", fixed = true, voxelsize = p.voxelsize, Solid.box{0.4, 0.2, 0.02}}
local slider = addObject{
  name = "slider", density = 500, voxelsize = p.voxelsize, position = {-0.1, 0, 0.05},
  Solid.box{0.06, 0.06, 0.04},
}

local rest = 0.01 + 0.02   -- centre of the slider when it lies on the plate
local hand = Devices.Hand{
  name = "hand",
  path = {
    {position = {-0.1, 0, 0.05}},
    {position = {-0.1, 0, rest - p.press}, speed = p.speed, dwell = 0.3},
    {position = {0.1, 0, rest - p.press}, speed = p.speed, dwell = 0.2},
    {position = {0.1, 0, 0.06}, speed = p.speed},
  },
}
addDevice(hand)
grasp(hand, slider)

local slid, low, high = 0, math.huge, -math.huge
Actions.addFrameAction(function()
  while true do
    if slider.contacts > 0 then
      local z = slider.position[3]
      slid = slid + 1
      low, high = math.min(low, z), math.max(high, z)
      measure("height_min", low - rest, "m")
      measure("height_max", high - rest, "m")
    end
    outcome(slid > 0 and "slid" or "no contact")
    Actions.waitForRedraw()
  end
end)
