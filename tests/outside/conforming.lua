-- A body in a seat that fits it closely: it is let go from `drop` above where it rests, and comes to rest.
-- clearance: on the radius. Gravity along -z.
local p = params{ kind="tube", clearance=0.00001, drop=0.000002, side=0.000001, voxelsize=0.002, timestep=0.001,
                  duration=1, hybrid="exact" }
defineSimulationParameters{ allBodiesAreDynamic=true, gravity={0, 0, -9.81}, timestep=p.timestep, duration=p.duration,
                            integrator="implicit", hybrid=p.hybrid }
local r, c = 0.01, p.clearance
local lying = AngleAxis(math.pi / 2, Axis{0, 1, 0})
local seats = {
  tube = function() return Solid.box{0.06, 0.06, 0.06} - Solid.cylinder{radius=r + c, height=0.1}:rotate(lying) end,
  socket = function() return Solid.box{0.06, 0.06, 0.03}:translate{0, 0, -0.015} - Solid.sphere{radius=r + c} end,
  cone = function() return Solid.box{0.06, 0.06, 0.04} - Solid.cone{radius1=0.002, radius2=0.022, height=0.04} end,
  bore = function() return Solid.box{0.06, 0.06, 0.06} - Solid.cylinder{radius=r + c, height=0.1}:rotate(lying) end,
  bowl = function() return Solid.box{0.06, 0.06, 0.03}:translate{0, 0, -0.025} - Solid.sphere{radius=0.03} end,
  ring = function() return Solid.box{0.08, 0.08, 0.02}:translate{0, 0, -0.01} - Solid.torus{ringRadius=0.02, radius=0.006 + c} end,
  plug = function() return Solid.box{0.06, 0.06, 0.03} - Solid.cone{radius1=0.007, radius2=0.013, height=0.03} end,
}
local bodies = {
  tube = function() return Solid.sphere{radius=r}, -c end,
  socket = function() return Solid.sphere{radius=r}, -c end,
  -- the cone's half angle is atan(1/2); its tip at z = -0.024, so the centre rests r * sqrt(5) above it
  cone = function() return Solid.sphere{radius=r}, -0.024 + r * math.sqrt(5) end,
  bowl = function() return Solid.sphere{radius=r}, -(0.03 - r) end,
  ring = function() return Solid.torus{ringRadius=0.02, radius=0.006}, -c end,
  bore = function() return Solid.cylinder{radius=r, height=0.04}:rotate(lying), -c end,
  plug = function() return Solid.cone{radius1=0.0075, radius2=0.0125, height=0.025}, 0 end,
}
local solid, z = bodies[p.kind]()
addObject{ name="seat", fixed=true, voxelsize=p.voxelsize, seats[p.kind]() }
addObject{ name="body", density=2000, voxelsize=p.voxelsize, position={0, p.side, z + p.drop}, solid }
