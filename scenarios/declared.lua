-- The pin and the block of peg_in_hole.lua with faces and edges declared by hand, as SPARTA's users did before models
-- brought their own: plane, cylinder and circle for the voxels that each passes through. `by = "solid"` takes those of
-- the solids instead; both recognize the same.
local p = params{
  by = "hand",              -- or "solid"
  voxelsize = 0.0045,       -- m
  approach = 0.004,         -- m, how far the operator misjudges the hole's place, sideways
  tremor = 0.0005,          -- m rms
  duration = 3,             -- s
}
local by_hand = p.by == "hand"
if not by_hand and p.by ~= "solid" then error("by is '" .. p.by .. "'; it is one of hand, solid") end
local hole, pin_radius, block_height, pin_height = 0.075, 0.07, 0.2, 0.4

defineSimulationParameters{ maxStiffness = 300, maxAngularStiffness = 0.1, hybrid = "restore", duration = p.duration }

local block = addObject{
  name = "block", fixed = true, density = 10, voxelsize = p.voxelsize, brep = not by_hand,
  Solid.box{0.375, 0.375, block_height} - Solid.cylinder{radius = hole, height = 0.3},
}
local up, through = 0.36, 0.06   -- the pin's centre with its end 60 mm above the block, and 40 mm below it
local pin = addObject{
  name = "pin", density = 10, voxelsize = p.voxelsize, position = {0, 0, up}, brep = not by_hand,
  Solid.cylinder{radius = pin_radius, height = pin_height},
}

-- A cylinder about z passes through a voxel if the box's nearest and farthest points lie on different sides of it.
local reach = p.voxelsize / 2
local function touches_cylinder(x, y, radius)
  local nearest = math.sqrt(math.max(0, math.abs(x) - reach)^2 + math.max(0, math.abs(y) - reach)^2)
  local farthest = math.sqrt((math.abs(x) + reach)^2 + (math.abs(y) + reach)^2)
  return nearest <= radius and radius <= farthest
end

local function cylinder(radius)
  local c = Cylinder()
  c.center, c.normal, c.radius = {0, 0, 0}, {0, 0, 1}, radius
  return BoundaryFeature(c)
end
local function plane(height, side)
  local f = Plane()
  f.point, f.normal = {0, 0, side * height / 2}, {0, 0, side}
  return BoundaryFeature(f)
end
local function rim(radius, height, side)
  local c = Circle()
  c.center, c.normal, c.radius = {0, 0, side * height / 2}, {0, 0, 1}, radius
  return BoundaryFeature(c)
end

-- The ends at +-height / 2 and what is round about the axis; the block's outer walls meet nothing and stay unknown.
local function declare(body, radius, height)
  body:foreachSurfaceVoxel(function(x, y, z)
    local set = FeatureSet()
    local is_round = touches_cylinder(x, y, radius)
    if is_round then set:insert(cylinder(radius)) end
    for _, side in ipairs{-1, 1} do
      if math.abs(z - side * height / 2) <= reach then
        set:insert(plane(height, side))
        if is_round then set:insert(rim(radius, height, side)) end
      end
    end
    body:addFeatureSet(set, x, y, z)
    return 0
  end)
end
if by_hand then
  declare(block, hole, block_height)
  declare(pin, pin_radius, pin_height)
end

local hand = Devices.Hand{
  name = "hand", ["repeat"] = true,
  path = {
    {position = {0, 0, up}, dwell = 0.2},
    {position = {0, 0, through}, speed = 0.3, dwell = 0.1},
  },
  error = {p.approach, 0, 0}, tremor = p.tremor, lead = 0.05, patience = 1.5,
}
addDevice(hand)
grasp(hand, pin)

Actions.addFrameAction(function()
  while true do
    if pin.position[3] - pin_height / 2 < -block_height / 2 then outcome("inserted") end
    Actions.waitForRedraw()
  end
end)
