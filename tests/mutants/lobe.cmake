# The radar's lobe is 1.4 times as wide.
set(source render/scattering/radar_image.c)
set(from [=[0.5 * lobe_rad * lobe_rad, 0.5e-18]=])
set(to [=[lobe_rad * lobe_rad, 0.5e-18]=])
