# What follows the first PDU of a datagram is lost.
set(source dis/datagram.c)
set(from [=[*at += next.length;]=])
set(to [=[*at = end;]=])
