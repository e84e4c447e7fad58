-- ISO 286-1 and 286-2: limits of size for holes H and the usual shafts, nominal sizes from 3 to 120 mm. Micrometres.
-- Source: ISO 286-1:2010, table 1 (standard tolerances) and tables 2 to 5 (fundamental deviations).
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

local function limits(fit, nominal)
  local hole_grade, letter, shaft_grade = fit:match("^H(%d+)/(%l)(%d+)$")
  local hole_it, shaft_it = grades[tonumber(hole_grade)], grades[tonumber(shaft_grade)]
  if not hole_it or not shaft_it or not (below[letter] or above[letter]) then
    error(string.format("fit is '%s'; this table has H5 to H11 with d e f g h k m n p r s, as in H7/g6", fit))
  end
  local row = row_of(nominal)
  local um = 1e-6
  local shaft_low, shaft_high
  if below[letter] then
    shaft_high = below[letter][row]
    shaft_low = shaft_high - shaft_it[row]
  else
    shaft_low = letter == "k" and tonumber(shaft_grade) > 7 and 0 or above[letter][row]
    shaft_high = shaft_low + shaft_it[row]
  end
  return 0, hole_it[row] * um, shaft_low * um, shaft_high * um
end

return limits
