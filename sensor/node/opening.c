/* sensor/node/opening.c: selects the datagrams on which the choices of a causal run are based. */
#include "sensor/node/opening.h"

#include "dis/datagram.h"
#include "dis/decode.h"

bool opening_own(const DisDatagram *datagram, const Config *config)
{
    DisCounters    ignored = {0};
    DisHeader      header;
    uint16_t       sender[2];
    const uint8_t *at = datagram->bytes, *pdu;
    return dis_next_pdu(&header, &pdu, &at, datagram->bytes + datagram->octets, &ignored) &&
           dis_pdu_sender(sender, &header, pdu) && sender[0] == config->node.site &&
           sender[1] == config->node.application;
}

int opening_drop_own(DisLog *log, const Config *config)
{
    int kept = 0;
    for (int i = 0; i < log->count; i++) {
        const DisDatagram datagram = dis_log_datagram(log, i);
        if (!opening_own(&datagram, config)) log->datagram[kept++] = log->datagram[i];
    }
    const int own = log->count - kept;
    log->count    = kept;
    return own;
}

bool opening_usable(const DisHeader *header, const uint8_t *pdu)
{
    DisPdu  decoded;
    DisDrop why;
    return header->type == dis_pdu_entity_state && dis_decode(&decoded, pdu, header->length) == STATUS_OK &&
           dis_entity_state_is_usable(&why, &decoded.entity_state);
}

bool opening_starts(DisHeader *out, const DisDatagram *datagram, const Config *config)
{
    DisCounters    ignored = {0};
    DisHeader      header;
    const uint8_t *at = datagram->bytes, *pdu;
    while (dis_next_pdu(&header, &pdu, &at, datagram->bytes + datagram->octets, &ignored)) {
        if (config->exercise.exercise >= 0 && header.exercise != config->exercise.exercise) continue;
        if (!opening_usable(&header, pdu)) continue;
        if (out) *out = header;
        return true;
    }
    return false;
}

double opening_until_s(const DisDatagram *starts, const Config *config)
{
    return starts->capture_s + config->exercise.listen_s;
}

bool opening_of(DisLog *view, DisLog *heard, double *until_s, const DisLog *log, const Config *config)
{
    int starts = 0, end;
    for (; starts < log->count; starts++) {
        const DisDatagram datagram = dis_log_datagram(log, starts);
        if (opening_starts(NULL, &datagram, config)) break;
    }
    if (starts == log->count) return false;
    *until_s = opening_until_s(&log->datagram[starts], config);
    for (end = starts; end < log->count && log->datagram[end].capture_s <= *until_s;) end++;
    const int begin = starts > opening_before ? starts - opening_before : 0;
    *view           = *log;
    view->datagram += begin;
    view->count -= begin;
    *heard       = *view;
    heard->count = end - begin;
    return true;
}
