/* dis/log.h: a recorded exercise: datagrams of a pcap or pcapng file,
 * compressed or not (dis/log_stream.h), with one link layer or one for each interface (dis/log_pcap.h).
 *
 * Link layers: Ethernet (with any VLAN tags), Linux cooked v1 and v2, BSD loopback, raw IP. IPv4 with
 * fragments put together again (bounded), IPv6 with extension headers; UDP to `port`. */
#ifndef DIS_LOG_H
#define DIS_LOG_H

#include "dis/log_datagrams.h"
#include "dis/pdu.h"

/* port: of the UDP destination. dis_port_any: every port, payloads that start with a DIS header.
 * dis_port_default: 3000, and when no datagram went there, any port (sets any_port). A file that is not
 * a capture, or cannot be read: a logged reason and the status. A truncated file: STATUS_OK, `truncated` set, a
 * warning. */
Status dis_log_open(DisLog *out, const char *path, int port);
/* The same, the file being read once. read: gets all of its octets in order, for a hash. */
typedef void DisLogRead(void *user, const void *octets, size_t count);
Status dis_log_open_read(DisLog *out, const char *path, int port, DisLogRead *read, void *user);
void   dis_log_close(DisLog *log);

/* Datagram i with its octets, which are valid until the next call but one; one thread at a time. One that cannot be read any
 * more has none, see dis_log_failed. */
DisDatagram dis_log_datagram(const DisLog *log, int i);
/* Whether a datagram could not be read, which was logged. */
bool        dis_log_failed(const DisLog *log);

/* dis_log_open does this. Packet times that run at another rate than the stamps of the sender with the most PDUs are
 * replaced by these, from the first packet on, in file order; true when they were. Stamps are used when
 * they step like a clock (-1 .. 120 s), span 5 s or more, and are not 20 times slower than the packets. */
bool   dis_log_retime(DisLog *log);

#endif
