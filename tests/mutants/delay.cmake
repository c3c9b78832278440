# Everybody but the eye is shown one frame late.
set(source sensor/node/session.c)
set(from [=[Status status = entity_table_snapshot(&snapshot, s->table, t_s, arena);]=])
set(to [=[Status status = entity_table_snapshot(&snapshot, s->table, t_s - 1 / s->plan.rate_hz, arena);]=])
