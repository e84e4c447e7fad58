-- A body slides over the seam of two tables of one height, or of `one` table that has none. n: sides or teeth.
local p = params{
  kind = "gear", r = 0.01, gap = 0, v = 0.3, turn = 0, yaw = 0, n = 8, spin = 0, timestep = 0.001, one = false,
}
local r, h, Y, Z = p.r, 0.6 * p.r, Axis{0, 1, 0}, Axis{0, 0, 1}
local way, side = 2.2 * r, 20 * r
defineSimulationParameters{
  hybrid = "exact", integrator = "implicit", gravity = {0, 0, -9.81}, allBodiesAreDynamic = true, timestep = p.timestep,
  duration = 2 * way / p.v,
}
local function table_at(name, x, length)
  addObject{name = name, fixed = true, voxelsize = r, Solid.box{length, side, r}:translate{x, 0, -r / 2}}
end
if p.one then
  table_at("table", 0, 2 * side)
else
  table_at("left", -side / 2 - p.gap, side)
  table_at("right", side / 2, side)
end
local function around(n, part, solid)  -- n times, each turned on
  for i = 1, n do solid = solid + part:rotate(AngleAxis(2 * math.pi * i / n, Z)) end
  return solid
end
local kinds = {  -- the solid, and how high its middle is
  box = function() return Solid.box{2 * r, 1.4 * r, h}, h / 2 end,
  cross = function() return Solid.box{2 * r, 0.6 * r, h} + Solid.box{0.6 * r, 2 * r, h}, h / 2 end,
  gear = function()
    local tooth = Solid.box{0.5 * r, 0.2 * r, h}:translate{0.75 * r, 0, 0}
    return around(p.n, tooth, Solid.cylinder{radius = 0.75 * r, height = h}), h / 2
  end,
  prism = function()
    local solid = Solid.cylinder{radius = 2 * r, height = h}
    for i = 1, p.n do solid = solid * Solid.box{2 * r, 8 * r, h}:rotate(AngleAxis(math.pi * i / p.n, Z)) end
    return solid, h / 2
  end,
  stool = function()
    local leg = Solid.cylinder{radius = 0.2 * r, height = h}:translate{0.7 * r, 0, 0}
    return around(3, leg, Solid.box{2 * r, 2 * r, h / 2}:translate{0, 0, h / 4}), h / 2
  end,
  bridge = function() return Solid.box{2 * r, r, h} - Solid.box{r, 2 * r, h}:translate{0, 0, -h / 2}, h / 2 end,
  disc = function() return Solid.cylinder{radius = r, height = h}, h / 2 end,
  tube = function() return Solid.tube{outer = r, inner = 0.6 * r, height = h}, h / 2 end,
  cone = function() return Solid.cone{radius1 = r, radius2 = 0.5 * r, height = h}, h / 2 end,
  roll = function() return Solid.cylinder{radius = 0.6 * r, height = 2 * r}:rotate(AngleAxis(math.pi / 2, Y)), 0.6 * r end,
  torus = function() return Solid.torus{ringRadius = 0.7 * r, radius = 0.3 * r}, 0.3 * r end,
  ball = function() return Solid.sphere{radius = r}, r end,
  fillet = function()  -- a box with two round lower edges
    local q = 0.2 * r
    local round = Solid.cylinder{radius = q, height = 2 * r}:rotate(AngleAxis(math.pi / 2, Y))
    return Solid.box{2 * r, 2 * r, h - q}:translate{0, 0, q / 2} + Solid.box{2 * r, 2 * r - 2 * q, h}
      + round:translate{0, r - q, q - h / 2} + round:translate{0, q - r, q - h / 2}, h / 2
  end,
}
local solid, z = kinds[p.kind]()
local cos, sin = math.cos(p.turn), math.sin(p.turn)
addObject{
  name = "body", density = 2000, voxelsize = r / 4, position = {-way * cos, -way * sin, z},
  velocity = {p.v * cos, p.v * sin, 0}, angularVelocity = {0, 0, p.spin}, solid:rotate(AngleAxis(p.yaw, Z)),
}
