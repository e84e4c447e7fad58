-- A body at rest on a plane, in a cone, a groove or a bowl: placed where it touches, under its weight alone.
local p = params{
  kind = "box", hybrid = "off", integrator = "semi-implicit", voxelsize = 0.002, duration = 3,
}
defineSimulationParameters{
  allBodiesAreDynamic = true, gravity = {0, 0, -9.81}, duration = p.duration, hybrid = p.hybrid, integrator = p.integrator,
}
local function ground(solid, z) addObject{name = "ground", fixed = true, voxelsize = p.voxelsize, position = {0, 0, z or 0}, solid} end
local function body(solid, x, y, z) addObject{name = "b", density = 1000, voxelsize = p.voxelsize, position = {x, y, z}, solid} end
local lying = AngleAxis(math.pi / 2, Axis{0, 1, 0})
local across = AngleAxis(math.pi / 2, Axis{1, 0, 0})
local function bowl()
  return Solid.box{0.24, 0.1, 0.12}:translate{0, 0, -0.06} - Solid.cylinder{radius = 0.1, height = 0.2}:rotate(across)
end
local scenes = {
  box = function()
    ground(Solid.box{0.2, 0.2, 0.02}, -0.01)
    body(Solid.box{0.06, 0.04, 0.04}, 0.003, 0.002, 0.02)
  end,
  sphere = function()
    ground(Solid.box{0.2, 0.2, 0.02}, -0.01)
    body(Solid.sphere{radius = 0.02}, 0.0013, 0.0007, 0.02)
  end,
  cylside = function()
    ground(Solid.box{0.2, 0.2, 0.02}, -0.01)
    body(Solid.cylinder{radius = 0.02, height = 0.08}:rotate(lying), 0.0013, 0.0007, 0.02)
  end,
  disc = function()
    ground(Solid.box{0.2, 0.2, 0.02}, -0.01)
    body(Solid.cylinder{radius = 0.02, height = 0.008}, 0.0007, 0.0003, 0.004)
  end,
  tube = function()
    ground(Solid.box{0.2, 0.2, 0.02}, -0.01)
    body(Solid.tube{outer = 0.016, inner = 0.008, height = 0.02}, 0.0011, -0.0004, 0.01)
  end,
  frustum = function()
    ground(Solid.box{0.2, 0.2, 0.02}, -0.01)
    body(Solid.cone{radius1 = 0.02, radius2 = 0.01, height = 0.02}, 0.0009, 0.0006, 0.01)
  end,
  spherecone = function()
    ground(Solid.box{0.14, 0.14, 0.04} - Solid.cone{radius1 = 0.01, radius2 = 0.05, height = 0.04}, -0.02)
    body(Solid.sphere{radius = 0.03}, 0.001, 0.0005, 0.03 * math.sqrt(2) - 0.05)
  end,
  vgroove = function()
    ground(Solid.box{0.2, 0.14, 0.06}:translate{0, 0, -0.03} - Solid.box{0.3, 0.06, 0.06}:rotate(AngleAxis(math.pi / 4, Axis{1, 0, 0})))
    body(Solid.cylinder{radius = 0.02, height = 0.08}:rotate(lying), 0, 0.001, (0.02 - 0.03) * math.sqrt(2))
  end,
  bowl = function()
    ground(bowl())
    body(Solid.sphere{radius = 0.02}, 0, 0, -0.08)
  end,
  bowlcyl = function()
    ground(bowl())
    body(Solid.cylinder{radius = 0.02, height = 0.06}:rotate(across), 0, 0, -0.08)
  end,
}
scenes[p.kind]()
