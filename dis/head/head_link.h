/* dis/head/head_link.h: datagrams of a head tracker over UDP: the newest pose, whenever it is asked for.
 *
 * A thread takes them as they arrive, so that a queue in the kernel holds no old ones back. */
#ifndef DIS_HEAD_HEAD_LINK_H
#define DIS_HEAD_HEAD_LINK_H

#include "dis/head/head_pose.h"

typedef struct HeadLink HeadLink;

typedef struct HeadCounters {
    uint64_t datagrams[HEAD_DROPS]; /* taken, or refused by reason */
} HeadCounters;

/* `ADDRESS:PORT`, on which is listened: a numeric IPv4 address of this machine, or IPv6 in brackets; a port in 1 ..
 * 65535. */
bool head_address_good(const char *address_port);
/* STATUS_BAD_VALUE or STATUS_IO, logged with what to do next. */
Status head_link_open(HeadLink **out, const char *address_port);
/* counters: NULL is valid, as it is for a link. */
void head_link_close(HeadLink *link, HeadCounters *counters);
/* False: none has come. */
bool head_link_newest(HeadPose *out, HeadLink *link);

#endif
