-- Half a ball that swings in a bowl: it slides and rolls without friction, and turns about all its axes.
-- a: its radius; wide: the bowl's, in a; steps: of sqrt(a / g), how many a step takes; tilt, about an axis at `turn` [rad]
local p = params{ a=0.01, wide=1.4, steps=30, tilt=0.7, turn=0, aside=0.2, voxelsize=0.001, duration=3 }
local a, g = p.a, 9.81
local R, rise = p.wide * a, (p.wide - 1) * a
defineSimulationParameters{ allBodiesAreDynamic=true, gravity={0, 0, -g}, timestep=math.sqrt(a / g) / p.steps,
                            duration=p.duration, integrator="implicit", hybrid="exact" }
addObject{ name="bowl", fixed=true, voxelsize=p.voxelsize,
  Solid.box{4 * R, 4 * R, 1.5 * R}:translate{0, 0, -0.75 * R} - Solid.sphere{radius=R} }
addObject{ name="b", density=2000, voxelsize=p.voxelsize,
  position={math.sin(p.aside) * rise, 0, -math.cos(p.aside) * rise},
  orientation=AngleAxis(p.tilt, Axis{math.cos(p.turn), math.sin(p.turn), 0}),
  Solid.sphere{radius=a} * Solid.box{3 * a, 3 * a, a}:translate{0, 0, -a / 2} }
