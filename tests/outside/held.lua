-- A part that a hand holds where it is, with weight: its weight acts where all bodies are dynamic, else a warning says so.
local p = params{dynamic = false, hybrid = "exact", integrator = "implicit"}
defineSimulationParameters{
  hybrid = p.hybrid, integrator = p.integrator, gravity = {0, 0, -9.81}, allBodiesAreDynamic = p.dynamic, maxStiffness = 300,
  duration = 2,
}
local b = addObject{name = "b", density = 2000, voxelsize = 0.002, Solid.box{0.03, 0.03, 0.03}}
local hand = Devices.Hand{name = "hand", path = {{position = {0, 0, 0}, dwell = 3}}}
addDevice(hand)
grasp(hand, b)
