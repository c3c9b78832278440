# The sun's light comes from 0.1 degree further round, though the sun is said to stand where it does.
set(source terrain/earth/sun.c)
set(from [=[.d_enu = {cos(elevation_rad) * sin(azimuth_rad), cos(elevation_rad) * cos(azimuth_rad),]=])
set(to [=[.d_enu = {cos(elevation_rad) * sin(azimuth_rad + 0.1 * rad_per_deg), cos(elevation_rad) * cos(azimuth_rad + 0.1 * rad_per_deg),]=])
