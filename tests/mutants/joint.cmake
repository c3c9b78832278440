# Turrets turn the other way.
set(source entities/motion/articulation.c)
set(from [=[if (node->dis_scale != 0) value[n] *= node->dis_scale;]=])
set(to [=[value[n] *= node->dis_scale != 0 ? -node->dis_scale : -1;]=])
