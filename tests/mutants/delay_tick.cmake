# Everybody but the eye is shown a hundredth of a second late.
set(source sensor/node/session/session_frame.c)
set(from [=[Status status = entity_table_snapshot(&f->seen.snapshot, s->table, t_s, f->arena);]=])
set(to [=[Status status = entity_table_snapshot(&f->seen.snapshot, s->table, t_s - 0.01, f->arena);]=])
