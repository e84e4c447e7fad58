-- What slides round without friction, and keeps its speed: a puck in a hole (of either height), a ring round a post, a
-- torus round a post. Without gravity; or with it a pendulum on a bar or in a bowl, whose amplitude stays.
local p = params{ kind = "puck", R = 0.1, r = 0.02, inner = 0.06, outer = 0.06, v = 1, start = 0.3, timestep = 0.001,
                  duration = 2, voxelsize = 0.002, swings = false }
defineSimulationParameters{ allBodiesAreDynamic = true, hybrid = "exact", integrator = "implicit", timestep = p.timestep,
                            duration = p.duration, gravity = {0, p.swings and -9.81 or 0, 0} }
local d = p.R - p.r
local block = Solid.box{2.6 * p.R, 2.6 * p.R, p.outer} - Solid.cylinder{radius = p.R, height = p.outer}
local inside = Solid.cylinder{radius = p.r, height = p.inner}
local around = p.kind == "torus" and Solid.torus{ringRadius = p.R + 0.01, radius = 0.01}
               or Solid.tube{outer = 1.2 * p.R, inner = p.R, height = p.outer}
local at, velocity = {d, 0, 0}, {0, p.v, 0}
if p.swings then at, velocity = {d * math.sin(p.start), -d * math.cos(p.start), 0}, {0, 0, 0} end
local fixed = p.kind == "puck" and block or inside
local moves = p.kind == "puck" and inside or around
addObject{name = "ground", fixed = true, voxelsize = p.voxelsize, fixed}
addObject{name = "b", density = 1000, voxelsize = p.voxelsize, position = at, velocity = velocity, moves}
