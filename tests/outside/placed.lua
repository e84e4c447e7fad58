-- A body of any size, placed where it can rest: on a plane, in a groove of 90 degrees, or in a bowl.
local p = params{
  seat = "plane", body = "disc", hybrid = "restore", integrator = "semi-implicit", duration = 3, voxelsize = 0.002,
  r = 0.02, h = 0.03, R = 0.08, density = 2000, x = 0.001, y = 0.002, yaw = 0, yaw_seat = 0,
}
defineSimulationParameters{
  allBodiesAreDynamic = true, gravity = {0, 0, -9.81}, duration = p.duration, hybrid = p.hybrid,
  integrator = p.integrator,
}
local X, Y, Z = Axis{1, 0, 0}, Axis{0, 1, 0}, Axis{0, 0, 1}
local bodies = {  -- the solid, and how high its middle is above a plane
  box = function() return Solid.box{2 * p.r, 1.5 * p.r, p.h}, p.h / 2 end,
  ball = function() return Solid.sphere{radius = p.r}, p.r end,
  disc = function() return Solid.cylinder{radius = p.r, height = p.h}, p.h / 2 end,
  roll = function() return Solid.cylinder{radius = p.r, height = p.h}:rotate(AngleAxis(math.pi / 2, Y)), p.r end,
  tube = function() return Solid.tube{outer = p.r, inner = 0.6 * p.r, height = p.h}, p.h / 2 end,
  frustum = function() return Solid.cone{radius1 = p.r, radius2 = 0.4 * p.r, height = p.h}, p.h / 2 end,
  torus = function() return Solid.torus{ringRadius = p.r, radius = 0.3 * p.r}, 0.3 * p.r end,
}
local body, height = bodies[p.body]()
local seats = {  -- the solid, and how high the body's middle is then
  plane = function() return Solid.box{0.2, 0.2, 0.02}:translate{0, 0, -0.01}, height end,
  groove = function()  -- its edge is 1.45 r deep
    local cut = Solid.box{0.4, 6 * p.r, 6 * p.r}:translate{0, 3 * p.r, 3 * p.r}:rotate(AngleAxis(math.pi / 4, X))
    local depth = 1.45 * p.r
    return Solid.box{0.2, 2.2 * depth + 0.04, 1.3 * depth}:translate{0, 0, -0.65 * depth} - cut:translate{0, 0, -depth},
      p.r * math.sqrt(2) - depth
  end,
  bowl = function()
    return Solid.box{2.4 * p.R, 2.4 * p.R, 1.2 * p.R}:translate{0, 0, -0.6 * p.R} - Solid.sphere{radius = p.R}, p.r - p.R
  end,
}
local seat, middle = seats[p.seat]()
addObject{name = "seat", fixed = true, voxelsize = p.voxelsize, seat:rotate(AngleAxis(p.yaw_seat, Z))}
addObject{
  name = "body", density = p.density, voxelsize = p.voxelsize, position = {p.x, p.y, middle},
  body:rotate(AngleAxis(p.yaw, Z)),
}
