-- A torus falls along a post that it fits closely, down to its foot.
local p = params{ clearance = 2.5e-6, vx = 0.1, vy = 0, vz = -0.12, spin = 0, timestep = 0.002 }
local post, tube = 0.0025, 0.0015
defineSimulationParameters{ hybrid = "exact", integrator = "implicit", allBodiesAreDynamic = true, gravity = {0, 0, -9.81},
  timestep = p.timestep, duration = 0.12 }
addObject{ name = "seat", fixed = true, voxelsize = 0.000625,
  Solid.box{ 0.04, 0.04, 0.005 }:translate{ 0, 0, -0.0025 } + Solid.cylinder{ radius = post, height = 0.03 }:translate{ 0, 0, 0.015 } }
addObject{ name = "ring", density = 7700, voxelsize = 0.000625, position = { 0, 0, 0.0065 },
  velocity = { p.vx, p.vy, p.vz }, angularVelocity = { 0, 0, p.spin }, Solid.torus{ ringRadius = post + tube + p.clearance, radius = tube } }
