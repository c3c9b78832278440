# What reflects diffusely emits as if it were black.
set(source render/light/surface_light.c)
set(from [=[(one() - diffuse - mirrors - through) * f32x8_load(emitted)]=])
set(to [=[(one() - mirrors - through) * f32x8_load(emitted)]=])
