-- Two bodies that hold each other: a slide, a shaft with its key, a hinge, a ball joint, links of a chain. Either a hand
-- moves one of them, to and fro and askew, or both fly freely (mode = "free") and rattle. c: clearance.
local p = params{
  kind = "dovetail", mode = "hand", c = 2e-5, yaw = 0.3, pitch = 0.2, speed = 0.1, side = 0.0005, tilt = 0.01, v = 0.1, w = 1,
  draw = 1, timestep = 0.001, voxelsize = 0.001, duration = 1.5,
}
local is_free = p.mode == "free"
defineSimulationParameters{
  hybrid = "exact", integrator = "implicit", timestep = p.timestep, duration = p.duration, maxStiffness = 2000,
  maxAngularStiffness = 5, allBodiesAreDynamic = is_free, gravity = {0, 0, 0},
}
local X, Y, Z = Axis{1, 0, 0}, Axis{0, 1, 0}, Axis{0, 0, 1}
local function box(x, y, z, at) return Solid.box{x, y, z}:translate(at) end
local function rod(r, h) return Solid.cylinder{radius = r, height = h} end
local function along_y(solid) return solid:rotate(AngleAxis(math.pi / 2, X)) end
local function dovetail(low, high, h, length)  -- along y: `low` wide at z = 0, `high` at h
  local lean = math.atan((low - high) / 2 / h)
  local function cut(side)
    return box(0.1, 2 * length, 0.1, {side * 0.05, 0, 0}):rotate(AngleAxis(-side * lean, Y)):translate{side * low / 2, 0, 0}
  end
  return box(3 * low, length, h, {0, 0, h / 2}) - cut(1) - cut(-1)
end
local function hexagon(r, h)
  local solid = Solid.box{2 * r, 6 * r, h}
  for i = 1, 2 do solid = solid * Solid.box{2 * r, 6 * r, h}:rotate(AngleAxis(math.pi / 3 * i, Z)) end
  return solid
end
local kinds = {  -- what stands still, what a hand moves, and whither
  dovetail = function(c)
    local groove = dovetail(0.02 + 2 * c, 0.0302 + 2 * c, 0.0102, 0.2):translate{0, 0, -1e-4}
    return box(0.06, 0.1, 0.02, {0, 0, -0.01}) + dovetail(0.02, 0.03, 0.01, 0.1), box(0.05, 0.04, 0.02, {0, 0, 0.01 + c}) - groove, Y
  end,
  tslot = function(c)
    local slot = box(0.01 + 2 * c, 0.2, 0.02, {0, 0, 0.003}) + box(0.024 + 2 * c, 0.2, 0.008 + 2 * c, {0, 0, 0.016})
    return box(0.01, 0.1, 0.012, {0, 0, 0.006}) + box(0.024, 0.1, 0.008, {0, 0, 0.016}), box(0.05, 0.04, 0.02, {0, 0, 0.014}) - slot, Y
  end,
  key = function(c)
    local bore = rod(0.01 + c, 0.1) + box(0.006 + 2 * c, 0.006 + 2 * c, 0.1, {0.009, 0, 0})
    return rod(0.01, 0.08) + box(0.006, 0.006, 0.05, {0.009, 0, 0}), rod(0.02, 0.025) - bore, Z
  end,
  hexagon = function(c) return hexagon(0.008, 0.1), rod(0.02, 0.025) - hexagon(0.008 + c, 0.1), Z end,
  bayonet = function(c)
    local slots = box(0.026, 0.004 + 2 * c, 0.05, {0, 0, 0.023 - c}) + (rod(0.013, 0.004 + 2 * c) - box(0.05, 0.004, 0.02, {0, -0.05, 0}))
    return rod(0.016, 0.04) - rod(0.008 + c, 0.1) - slots, rod(0.008, 0.06) + Solid.box{0.024, 0.004, 0.004}, nil
  end,
  hinge = function(c)
    local cheek = function(side) return box(0.03, 0.01, 0.03, {0, side * (0.0105 + c), 0}) end
    local lug = box(0.05, 0.011, 0.014, {0.02, 0, 0}) + along_y(rod(0.011, 0.011))
    return cheek(1) + cheek(-1) + box(0.01, 0.04, 0.03, {-0.02, 0, 0}) + along_y(rod(0.006, 0.031)), lug - along_y(rod(0.006 + c, 0.1)), nil
  end,
  collars = function(c)
    local collar = function(side) return rod(0.012, 0.01):translate{0, 0, side * (0.0151 + c)} end
    return rod(0.008, 0.06) + collar(1) + collar(-1), rod(0.014, 0.02) - rod(0.008 + c, 0.1), nil
  end,
  balljoint = function(c)
    local socket = rod(0.015, 0.02) - Solid.sphere{radius = 0.008 + c} - box(0.05, 0.05, 0.02, {0, 0, 0.014})
    return socket, Solid.sphere{radius = 0.008} + rod(0.003, 0.02):translate{0, 0, 0.015}, nil
  end,
  chain = function()
    local link = function() return Solid.torus{ringRadius = 0.012, radius = 0.004} end
    return link(), along_y(link()):translate{0.012, 0, 0}, X
  end,
}
local seat, body, along = kinds[p.kind](p.c)
local pitch, yaw = AngleAxis(p.pitch, X), AngleAxis(p.yaw, Z)
local function placed(solid) return solid:rotate(pitch):rotate(yaw) end
local function drawn(size, a, b, c) return {size * math.sin(a * p.draw), size * math.sin(b * p.draw), size * math.sin(c * p.draw)} end
local still = {0, 0, 0}
addObject{name = "seat", fixed = not is_free, density = 3000, voxelsize = p.voxelsize, placed(seat)}
local moved = addObject{
  name = "body", density = 3000, voxelsize = p.voxelsize, velocity = is_free and drawn(p.v, 3.1, 5.3, 7.7) or still,
  angularVelocity = is_free and drawn(p.w, 2.3, 4.9, 8.1) or still, placed(body),
}
if not is_free then
  local way = along and yaw * (pitch * osg.Vec3(along[1], along[2], along[3])) or still
  local aside, axis = drawn(p.side, 3.1, 5.3, 7.7), drawn(1, 2.3, 4.9, 8.1)
  local function at(z) return {z * way[1] + aside[1], z * way[2] + aside[2], z * way[3] + aside[3]} end
  local askew = AngleAxis(p.tilt, Axis{axis[1], axis[2], axis[3]})
  local hand = Devices.Hand{
    name = "hand", stiffness = 400, angularStiffness = 3,
    path = {
      {position = {0, 0, 0}, dwell = 0.05}, {position = at(0.012), orientation = askew, speed = p.speed, dwell = 0.1},
      {position = at(-0.012), orientation = askew, speed = p.speed, dwell = 0.1}, {position = at(0.006), speed = p.speed, dwell = 0.6},
    },
  }
  addDevice(hand)
  grasp(hand, moved)
end
