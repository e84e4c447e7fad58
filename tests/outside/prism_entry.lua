-- A prism of n sides with a lead-in goes into a hole of the same section, c larger on each flat. The hand misjudges the
-- hole by half a millimetre and half a degree. n = 0: a round pin. chamfer_by: "planes" or "cone".
local p = params{ n=8, c=0.00002, chamfer_by="planes", hybrid="exact", voxelsize=0.001, timestep=0.001, error=0.0005, tilt=deg(0.5),
  tremor=0.00002, speed=0.05, dir=20 }
local R, L, H, ch = 0.010, 0.06, 0.03, 0.001
defineSimulationParameters{ hybrid=p.hybrid, integrator="implicit", timestep=p.timestep, maxStiffness=2000, maxAngularStiffness=5,
  maxCouplingForce=35, maxCouplingTorque=3 }
local function rotz(s, a) return s:rotate(AngleAxis(a, Axis{0,0,1})) end
local function section(a, h)
  if p.n == 0 then return Solid.cylinder{radius=a, height=h} end
  local s
  for i = 0, p.n - 1 do
    local b = rotz(Solid.box{8*a, 16*a, h}:translate{-3*a, 0, 0}, 2*math.pi*i/p.n)
    s = s and (s*b) or b
  end
  return s
end
local peg = section(R, L)
if p.n == 0 then
  peg = Solid.cylinder{radius=R, height=L-ch}:translate{0,0,ch/2} + Solid.cone{radius1=R-ch, radius2=R, height=ch}:translate{0,0,-L/2+ch/2}
elseif p.chamfer_by == "planes" then
  for i = 0, p.n - 1 do
    local cut = Solid.box{0.1,0.2,0.1}:translate{0,0,-0.05}:rotate(AngleAxis(-math.pi/4, Axis{0,1,0})):translate{R-ch,0,-L/2}
    peg = peg - rotz(cut, 2*math.pi*i/p.n)
  end
else
  peg = peg * (Solid.cone{radius1=R-ch, radius2=R+14*ch, height=15*ch}:translate{0,0,-L/2+7.5*ch} + Solid.cylinder{radius=0.03, height=L}:translate{0,0,14*ch})
end
addObject{ name="block", fixed=true, density=7800, voxelsize=p.voxelsize, Solid.box{0.1,0.1,H} - section(R+p.c, H+0.01) }
local seat = L/2 - H/2 - 0.005
local a = math.rad(p.dir)
local dx, dy = math.cos(a), math.sin(a)
local zstart = H/2 + L/2 + 0.005
local turn = AngleAxis(p.tilt, Axis{-dy,dx,0})
local up = turn*osg.Vec3(0,0,L/2)
local body = addObject{ name="peg", density=7800, voxelsize=p.voxelsize, position=osg.Vec3(p.error*dx, p.error*dy, zstart-L/2)+up, orientation=turn, peg }
local hand = Devices.Hand{ name="hand", lead=0.02, error={p.error*dx+up[1], p.error*dy+up[2], 0}, angularError={-dy*p.tilt, dx*p.tilt, 0},
  tremor=p.tremor, angularStiffness=2, path={ {position={0,0,zstart}, dwell=0.1}, {position={0,0,seat-0.001}, speed=p.speed, dwell=0.5} } }
addDevice(hand) grasp(hand, body)
local lowest = math.huge
Actions.addFrameAction(function() while true do
  lowest = math.min(lowest, body.position[3])
  outcome(lowest < seat+0.001 and "inserted" or "not inserted")
  Actions.waitForRedraw() end end)
