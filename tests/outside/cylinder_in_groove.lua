-- A cylinder (20 x 30 mm) falls into a 90 degree groove, under gravity alone. As it is shipped its side lies on a wall of the
-- groove, with its rim at the groove's upper edge: a rim on an edge. Judged by outside_test.py.
local p = params{ hybrid="exact", voxelsize=0.002, timestep=0.001, duration=0.4,
  x=0.003895181673100487, y=0.005452237769859575, z=-0.0031758861748037064,
  qx=-0.020017404495153875, qy=0.38219372550454433, qz=-0.03254959258596269, qw=0.9232918193749592,
  vx=-0.06628517436598537, vy=0.009017684059041057, vz=-0.06628514874857498,
  wx=2.5946055054950214, wy=0.0372355319920869, wz=1.7629732180476125 }
defineSimulationParameters{ allBodiesAreDynamic=true, gravity={0,0,-9.81}, duration=p.duration, hybrid=p.hybrid,
  integrator="implicit", timestep=p.timestep }
addObject{ name="seat", fixed=true, voxelsize=p.voxelsize,
  Solid.box{0.3,0.3,0.04}:translate{0,0,-0.02} - Solid.box{0.03,0.5,0.03}:rotate(AngleAxis(math.pi/4,Axis{0,1,0})) }
addObject{ name="b", density=2000, voxelsize=p.voxelsize, position={p.x,p.y,p.z}, orientation={p.qx,p.qy,p.qz,p.qw},
  velocity={p.vx,p.vy,p.vz}, angularVelocity={p.wx,p.wy,p.wz}, Solid.cylinder{radius=0.01,height=0.03} }
