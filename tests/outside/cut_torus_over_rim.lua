-- The upper part of a torus slides down a wide cone and over its rim, below which is the cone's base.
local p = params{ turn = 4, outward = 0.28, across = 0.06, spin = 0, timestep = 0.001, duration = 0.3 }
local cos, sin = math.cos(p.turn), math.sin(p.turn)
defineSimulationParameters{ hybrid = "exact", integrator = "implicit", allBodiesAreDynamic = true, gravity = {0, 0, -9.81},
  timestep = p.timestep, duration = p.duration }
addObject{ name = "seat", fixed = true, voxelsize = 0.0019, Solid.cone{ radius1 = 0.056, radius2 = 0.0056, height = 0.028 } }
addObject{ name = "ring", density = 3000, voxelsize = 0.0006,
  position = { 0.0115 * cos, 0.0115 * sin, 0.0124 }, velocity = { p.outward * cos - p.across * sin, p.outward * sin + p.across * cos, -0.056 },
  angularVelocity = { 0, 0, p.spin }, Solid.torus{ ringRadius = 0.0025, radius = 0.00096 } - Solid.box{ 0.014, 0.014, 0.014 }:translate{ 0, 0, -0.0067 } }
