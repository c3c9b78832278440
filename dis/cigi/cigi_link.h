/* dis/cigi/cigi_link.h: datagrams to and from one CIGI host over UDP. */
#ifndef DIS_CIGI_CIGI_LINK_H
#define DIS_CIGI_CIGI_LINK_H

#include "pitviper.h"

typedef struct CigiLink CigiLink;

/* `HOST:PORT`, where Start of Frame goes: a numeric IPv4 address, or IPv6 in brackets; a port in 1 .. 65535. */
bool cigi_link_address_good(const char *host_port);
/* `recorded` in place of an address: the host of the recording that is replayed. */
bool cigi_link_recorded(const char *host_port);
/* own_port: on which this program listens. STATUS_BAD_VALUE or STATUS_IO, logged with what to do next. */
Status cigi_link_open(CigiLink **out, const char *host_port, int own_port);
void   cigi_link_close(CigiLink *link); /* accepts NULL */

/* Waits at most wait_s for a datagram of the host's address, from any of its ports; those of others are counted. False:
 * none came. The octets are the link's until the next call. */
bool cigi_link_receive(const uint8_t **datagram, size_t *octets, CigiLink *link, double wait_s);
/* What cannot be sent is lost, as on the network, and counted. */
void cigi_link_send(CigiLink *link, const uint8_t *datagram, size_t octets);
/* Address and port that Start of Frame goes to; IPv4 as ::ffff:a.b.c.d. */
void     cigi_link_host(uint8_t address[16], uint16_t *port, const CigiLink *link);
uint64_t cigi_link_foreign(const CigiLink *link);
uint64_t cigi_link_unsent(const CigiLink *link);

#endif
