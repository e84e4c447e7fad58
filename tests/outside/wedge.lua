-- A hand turns a pin in its hole three times as far as it can go. `entered`: how far the pin's lower end is below the
-- block's upper face; more than the block's height: both rims of the hole stop it, else the upper one and its own edge.
local p = params{clearance = 0.00005, entered = 0.3, turn = 0.001, stiffness = 3000, voxelsize = 0.0045, timestep = 0.001}
local R, L, H = 0.075, 0.4, 0.2
defineSimulationParameters{
  hybrid = "exact", integrator = "implicit", timestep = p.timestep, maxStiffness = p.stiffness, maxAngularStiffness = 20,
  maxCouplingForce = 100, maxCouplingTorque = 100,
}
addObject{
  name = "block", fixed = true, density = 10, voxelsize = p.voxelsize,
  Solid.box{0.375, 0.375, H} - Solid.cylinder{radius = R, height = 2 * H},
}
local z = H / 2 - p.entered + L / 2
local pin = addObject{
  name = "pin", density = 10, voxelsize = p.voxelsize, position = {0, 0, z}, Solid.cylinder{radius = R - p.clearance, height = L},
}
local path = {{position = {0, 0, z}, dwell = 0.1}}
for i = 1, 20 do
  path[#path + 1] = {position = {0, 0, z}, orientation = AngleAxis(3 * p.turn * i / 20, Axis{0, 1, 0}), dwell = 0.04}
end
path[#path].dwell = 1
local hand = Devices.Hand{name = "hand", path = path, stiffness = p.stiffness, angularStiffness = 20}
addDevice(hand)
grasp(hand, pin)
