# Algorithms 8 and 9 forget the acceleration along the path.
set(source entities/motion/dead_reckoning.c)
set(from [=[moved[i] = accelerates ? by_v[i] + by_a[i] : by_v[i];]=])
set(to [=[(void)by_a; moved[i] = by_v[i];]=])
