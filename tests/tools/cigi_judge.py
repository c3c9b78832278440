"""tests/tools/cigi_judge.py VALUES PDML: whether tshark's dissection of CIGI datagrams (-T pdml) has the values (lines of
JSON of tests/tools/cigi_packets.c), field by field, each at the kind of packet and of the size that was written. Says how
many fields agree; every difference is printed and makes the exit code 1."""
import json
import sys
import xml.etree.ElementTree as xml

# id: tshark's name of the packet, and of its fields in the order of ours
NAMES = {
    1: ('ig_control', 'version db_number ig_mode timestamp_valid extrapolation_enable minor_version host_frame_number '
        'timestamp last_ig_frame_number'),
    2: ('entity_control', 'entity_id entity_state attach_state coll_det_request inherit_alpha ground_ocean_clamp '
        'animation_dir animation_loop_mode animation_state extrapolation_enable alpha entity_type parent_id roll pitch '
        'yaw lat_xoff lon_yoff alt_zoff'),
    8: ('rate_control', 'entity_id part_id apply_to_part coordinate_system x_rate y_rate z_rate roll_rate pitch_rate yaw_rate'),
    16: ('view_control', 'view_id group_id xoff_enable yoff_enable zoff_enable roll_enable pitch_enable yaw_enable '
         'entity_id xoff yoff zoff roll pitch yaw'),
    17: ('sensor_control', 'view_id sensor_id sensor_on_off polarity line_dropout_enable auto_gain track_white_black '
         'track_mode response_type gain level ac_coupling noise'),
    21: ('view_def', 'view_id group_id near_enable far_enable left_enable right_enable top_enable bottom_enable '
         'mirror_mode pixel_replication projection_type reorder view_type near far left right top bottom'),
    24: ('hat_hot_request', 'hat_hot_id type coordinate_system update_period entity_id lat_xoff lon_yoff alt_zoff'),
    25: ('los_segment_request', 'los_id type source_coord destination_coord response_coord '
         'destination_entity_id_valid alpha_threshold entity_id source_lat_xoff source_lon_yoff source_alt_zoff '
         'destination_lat_xoff destination_lon_yoff destination_alt_zoff material_mask update_period '
         'destination_entity_id'),
    26: ('los_vector_request', 'los_id type source_coord response_coord alpha entity_id azimuth elevation min_range '
         'max_range source_lat_xoff source_lon_yoff source_alt_zoff material_mask update_period'),
    101: ('sof', 'version db_number ig_status ig_mode timestamp_valid earth_reference_model minor_version '
          'ig_frame_number timestamp last_host_frame_number'),
    102: ('hat_hot_response', 'hat_hot_id valid type host_frame_number_lsn height'),
    103: ('hat_hot_ext_response', 'hat_hot_id valid host_frame_number_lsn hat hot material_code normal_vector_azimuth '
          'normal_vector_elevation'),
    104: ('los_response', 'los_id valid entity_id_valid visible host_frame_number_lsn count entity_id range'),
    105: ('3_2_los_ext_response', 'los_id valid entity_id_valid range_valid visible host_frame_number_lsn '
          'response_count entity_id range lat_xoff lon_yoff alt_zoff red green blue alpha material_code '
          'normal_vector_azimuth normal_vector_elevation'),
    106: ('sensor_response', 'view_id sensor_id sensor_status gate_x_size gate_y_size gate_x_pos gate_y_pos frame_ctr'),
    107: ('sensor_ext_response', 'view_id sensor_id sensor_status entity_id_valid entity_id gate_x_size gate_y_size '
          'gate_x_pos gate_y_pos frame_ctr track_lat track_lon track_alt'),
}


def tshark_name(packet, field):
    return 'cigi.version' if field == 'version' else f'cigi.{packet}.{field}'


def differs(shown, want, octets):
    """tshark prints a float of 32 bits by 6 digits, one of 64 by 15."""
    number = float(shown)
    return abs(number - want) > {4: 1e-5, 8: 1e-14}.get(octets, 0) * abs(want)


def judge(values, pdml):
    datagrams = [[] for _ in range(1 + max(v['datagram'] for v in values))]
    for v in values:
        datagrams[v['datagram']].append(v)
    read = list(xml.parse(pdml).getroot().iter('packet'))
    wrong = [] if len(read) == len(datagrams) else [f'{len(datagrams)} datagrams written, {len(read)} read']
    fields = 0
    for n, (sent, packet) in enumerate(zip(datagrams, read)):
        proto = next(p for p in packet.iter('proto') if p.get('name') == 'cigi')
        trees = [f for f in proto if f.get('name', '').startswith('cigi.') and f.find('field') is not None]
        if len(trees) != len(sent):
            wrong.append(f'datagram {n}: {len(sent)} packets written, {len(trees)} read')
            continue
        for v, tree in zip(sent, trees):
            name, ours = NAMES[v['id']][0], v['fields']
            theirs = NAMES[v['id']][1].split()
            where = f"datagram {n}, {v['name']}"
            found = {f.get('name'): f for f in tree.iter('field')}
            size = int(found['cigi.packet_size'].get('show'))
            if tree.get('name') != f'cigi.{name}' or size != v['octets'] or len(theirs) != len(ours):
                wrong.append(f"{where}: read as {tree.get('name')}, {size} octets, {len(ours)} fields")
                continue
            for (field, want), their in zip(ours.items(), theirs):
                shown = found.get(tshark_name(name, their))
                fields += 1
                if shown is None:
                    wrong.append(f'{where}: no {their}')
                elif differs(shown.get('show'), want, int(shown.get('size'))):
                    wrong.append(f"{where}: {field} is {want}, {their} {shown.get('show')}")
    return fields, wrong


def main():
    values = [json.loads(line) for line in open(sys.argv[1], encoding='ascii')]
    fields, wrong = judge(values, sys.argv[2])
    print('\n'.join(wrong[:20]))
    print(f'{fields} fields, {len(wrong)} differ')
    return bool(wrong) or fields == 0


if __name__ == '__main__':
    sys.exit(main())
