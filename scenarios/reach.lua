-- An Omni that nobody holds yet, in a bubble: bind a trace to it. It carries a box farther than it reaches by itself; a
-- wall stands in the way.
--   build/verisim trace synth reach -o reach.csv --set to_x=0.07 --set time=2 --set wait=1
--   ./run scenarios/reach.lua --bind omni=reach.csv
-- Bubble: SPARTA's for the Omni (radius and stiffness as published). law: "linear", "quadratic", "cubic", "peak-ring".
local p = params{ law = "peak-ring",
  velocityScale = 1.5, radius = 0.45, stiffness = 50, stop = false, bump = 0, wall = 2.0, scale = 10 }
defineSimulationParameters{ maxStiffness = 300 }
addObject{ name = "wall", fixed = true, voxelsize = 0.02, position = {p.wall, 0, 0}, Solid.box{0.1, 1, 1} }
local box = addObject{ name = "box", voxelsize = 0.02, Solid.box{0.2, 0.2, 0.2} }
local omni = Devices.Sensable.PhantomOmni{ name = "omni", scale = p.scale }
local device = BubbleTechnique{ device = omni, radius = p.radius, stiffness = p.stiffness, bubbleVelocityScale = p.velocityScale,
  law = p.law, stopInCollision = p.stop, deviceCenter = {0, 0, 0} }
if p.bump > 0 then device = bumpDevice{ device, force = p.bump } end
addDevice(device)
grasp(device, box)
local felt, farthest = 0, 0
Actions.addFrameAction(function()
  while true do
    felt, farthest = math.max(felt, device.forces:length()), math.max(farthest, box.position[1])
    measure("felt at most", felt, "N")
    measure("carried", farthest, "m")
    outcome(farthest > p.wall - 0.16 and "carried to the wall" or "not carried so far")
    Actions.waitForRedraw()
  end
end)
