# What follows the first PDU of a datagram is lost.
set(source dis/pdu/decode.c)
set(from [=[*at += next.length;]=])
set(to [=[*at = end;]=])
