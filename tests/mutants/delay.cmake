# Everybody but the eye is shown one frame late.
set(source sensor/node/session/session_frame.c)
set(from [=[Status status = entity_table_snapshot(&f->seen.snapshot, s->table, t_s, f->arena);]=])
set(to [=[Status status = entity_table_snapshot(&f->seen.snapshot, s->table, t_s - 1 / s->plan.rate_hz, f->arena);]=])
