-- ISO 286-1 and 286-2: limits of size for the usual holes and shafts, nominal sizes from 3 to 120 mm. Micrometres.
-- Source: ISO 286-1:2010, table 1 (standard tolerances) and tables 2 to 5 (fundamental deviations). By its 4.3.2.5 the
-- holes D to H mirror the shafts d to h, EI = -es; js and JS lie half to each side, -IT/2 to +IT/2.
--   limits("H7/g6", 25) -> hole's lower and upper deviation, shaft's lower and upper deviation [m, on the diameter]
local upper = {3, 6, 10, 18, 30, 50, 65, 80, 100, 120}  -- mm: a row ends with this nominal size

local grades = {  -- standard tolerance
  [5] = {4, 5, 6, 8, 9, 11, 13, 13, 15, 15},
  [6] = {6, 8, 9, 11, 13, 16, 19, 19, 22, 22},
  [7] = {10, 12, 15, 18, 21, 25, 30, 30, 35, 35},
  [8] = {14, 18, 22, 27, 33, 39, 46, 46, 54, 54},
  [9] = {25, 30, 36, 43, 52, 62, 74, 74, 87, 87},
  [10] = {40, 48, 58, 70, 84, 100, 120, 120, 140, 140},
  [11] = {60, 75, 90, 110, 130, 160, 190, 190, 220, 220},
}
local below = {  -- shafts thinner than nominal: upper deviation
  d = {-20, -30, -40, -50, -65, -80, -100, -100, -120, -120},
  e = {-14, -20, -25, -32, -40, -50, -60, -60, -72, -72},
  f = {-6, -10, -13, -16, -20, -25, -30, -30, -36, -36},
  g = {-2, -4, -5, -6, -7, -9, -10, -10, -12, -12},
  h = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0},
}
local above = {  -- shafts thicker than nominal: lower deviation (k: to grade 7; 0 beyond)
  k = {0, 1, 1, 1, 2, 2, 2, 2, 3, 3},
  m = {2, 4, 6, 7, 8, 9, 11, 11, 13, 13},
  n = {4, 8, 10, 12, 15, 17, 20, 20, 23, 23},
  p = {6, 12, 15, 18, 22, 26, 32, 32, 37, 37},
  r = {10, 15, 19, 23, 28, 34, 41, 43, 51, 54},
  s = {14, 19, 23, 28, 35, 43, 53, 59, 71, 79},
}

local function row_of(nominal)
  local mm = nominal * 1000
  if mm > 3 - 1e-9 then
    for i, last in ipairs(upper) do
      if mm <= last + 1e-9 then return i end
    end
  end
  error(string.format("nominal is %g mm; this table has 3 to 120 mm", mm))
end

-- Lower and upper deviation of a hole or shaft such as H7, js6; nothing if this table does not have it.
local function deviations(zone, row)
  local letter, grade = zone:match("^(%a+)(%d+)$")
  local it = grades[tonumber(grade)]
  if not it then return end
  if letter == "js" or letter == "JS" then return -it[row] / 2, it[row] / 2 end
  if below[letter] then return below[letter][row] - it[row], below[letter][row] end
  if above[letter] then
    local low = letter == "k" and tonumber(grade) > 7 and 0 or above[letter][row]
    return low, low + it[row]
  end
  local mirrored = letter == letter:upper() and below[letter:lower()]
  if mirrored then return -mirrored[row], it[row] - mirrored[row] end
end

local function limits(fit, nominal)
  local row = row_of(nominal)
  local hole, shaft = fit:match("^(%u+%d+)/(%l+%d+)$")
  local hole_low, hole_high = deviations(hole or "", row)
  local shaft_low, shaft_high = deviations(shaft or "", row)
  if not hole_low or not shaft_low then
    error(string.format("fit is '%s'; this table has holes D E F G H JS and shafts d e f g h js k m n p r s, grades " ..
                        "5 to 11, as in H7/g6", fit))
  end
  local um = 1e-6
  return hole_low * um, hole_high * um, shaft_low * um, shaft_high * um
end

return limits
