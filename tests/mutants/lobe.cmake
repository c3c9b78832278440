# The radar's lobe is 1.4 times as wide.
set(source render/radar_image.c)
set(from [=[const double s2 = 0.5 * lobe_rad * lobe_rad;]=])
set(to [=[const double s2 = lobe_rad * lobe_rad;]=])
