# The sun stands 0.1 degree further round.
set(source terrain/earth/sun.c)
set(from [=[if (azimuth_rad < 0) azimuth_rad += 2 * pi_rad;]=])
set(to [=[azimuth_rad += 0.1 * rad_per_deg; if (azimuth_rad < 0) azimuth_rad += 2 * pi_rad;]=])
