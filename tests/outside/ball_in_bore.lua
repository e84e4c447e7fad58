-- A ball in a fixed tube, hardly smaller than its bore, without gravity. It moves along the bore and to a side.
local p = params{ clearance = 6e-6, radius = 0.006, v = 0.6, angle = 1, along = 0.7, timestep = 0.001 }
defineSimulationParameters{ hybrid = "exact", integrator = "implicit", allBodiesAreDynamic = true, gravity = {0, 0, 0},
  timestep = p.timestep, duration = 0.01 }
addObject{ name = "tube", fixed = true, voxelsize = 0.00125,
  Solid.tube{ outer = p.radius / 0.6, inner = p.radius, height = p.radius / 0.15 } }
addObject{ name = "ball", density = 7400, voxelsize = 0.00125,
  velocity = { p.v * math.cos(p.angle), p.v * math.sin(p.angle), p.along }, Solid.sphere{ radius = p.radius - p.clearance } }
