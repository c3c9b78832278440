/* dis/log_packet.h: from the packets of a capture to the datagrams of a log; for log.c only. */
#ifndef DIS_LOG_PACKET_H
#define DIS_LOG_PACKET_H

#include "dis/log_datagrams.h"
#include "dis/log_pcap.h"

typedef struct DisPacketReader DisPacketReader;

/* Datagrams to `port` (dis_port_any: payloads that start with a DIS header; dis_port_default: to 3000, and those while there
 * are none) are appended to the log, their octets in the arena, beyond dis_log_in_memory in log->file; packets without one are
 * counted there. */
Status dis_packet_reader_create(DisPacketReader **out, DisLog *log, Arena *arena, int port);
void   dis_packet_reader_destroy(DisPacketReader *reader);

bool   dis_packet_reads(int link); /* LINKTYPE_; whether this link layer is read */
/* One packet of a link layer that is read; the log's counters.packets is its number. STATUS_NO_MEMORY. */
Status dis_packet_read(DisPacketReader *reader, const DisCapturePacket *packet);
/* There are no more: datagrams in reassembly are dropped. True: of dis_port_default, none went to 3000, and other UDP was
 * there. */
bool   dis_packet_reader_end(DisPacketReader *reader);

#endif
