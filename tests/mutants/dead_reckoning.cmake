# Algorithms 4 and 5 forget a t^2 / 2.
set(source entities/motion/dead_reckoning.c)
set(from [=[out->p[i] = in->p[i] + t * (in->v[i] + 0.5 * t * a);]=])
set(to [=[out->p[i] = in->p[i] + t * in->v[i];]=])
