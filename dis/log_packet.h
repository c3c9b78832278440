/* dis/log_packet.h: from the packets of a capture to the datagrams of a log; for log.c only. */
#ifndef DIS_LOG_PACKET_H
#define DIS_LOG_PACKET_H

#include "dis/log_datagrams.h"

typedef struct DisPacketReader DisPacketReader;

/* Datagrams to `port` (0: to any, payloads that start with a DIS header) are appended to the log, their octets in the
 * arena; packets without one are counted there. */
Status dis_packet_reader_create(DisPacketReader **out, DisLog *log, Arena *arena, uint16_t port);
void   dis_packet_reader_destroy(DisPacketReader *reader);

bool   dis_packet_reads(int link); /* LINKTYPE_; whether this link layer is read */
/* One packet of a link layer that is read; the log's counters.packets is its number. STATUS_NO_MEMORY. */
Status dis_packet_read(DisPacketReader *reader, int link, double capture_s, const uint8_t *bytes, size_t octets);
/* There are no more: datagrams in reassembly are dropped. */
void   dis_packet_reader_end(DisPacketReader *reader);

#endif
