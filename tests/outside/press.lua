-- A ball that a hand presses 10 mm "into" a plate: two springs in series, the hand's 400 N/m and the coupling's 300 N/m.
local p = params{hybrid = "", integrator = "", voxelsize = 0.002, press = 0.01}
defineSimulationParameters{
  maxStiffness = 300, hybrid = p.hybrid ~= "" and p.hybrid or nil, integrator = p.integrator ~= "" and p.integrator or nil,
}
addObject{name = "wall", fixed = true, voxelsize = p.voxelsize, Solid.box{0.2, 0.1, 0.02}:translate{0, 0, -0.01}}
local above = 0.025
local tool = addObject{
  name = "tool", density = 200, voxelsize = p.voxelsize, position = {0.0003, 0.0002, above}, Solid.sphere{radius = 0.015},
}
local hand = Devices.Hand{
  name = "hand",
  path = {
    {position = {0.0003, 0.0002, above}, dwell = 0.1},
    {position = {0.0003, 0.0002, above - 0.01 - p.press}, speed = 0.05, dwell = 2},
  },
}
addDevice(hand)
grasp(hand, tool)
