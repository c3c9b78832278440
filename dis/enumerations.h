/* dis/enumerations.h: the values of SISO-REF-010 used by Pitviper. */
#ifndef DIS_ENUMERATIONS_H
#define DIS_ENUMERATIONS_H

enum {
    dis_kind_platform = 1, dis_kind_munition = 2, dis_kind_life_form = 3, dis_kind_cultural_feature = 5,
    dis_kind_supply = 6, dis_kind_expendable = 8, dis_kind_sensor_emitter = 9
};
enum { dis_munition_guided = 1, dis_munition_fixed = 3 }; /* category of a munition; 2: ballistic; fixed: mines */
enum {
    dis_domain_land = 1, dis_domain_air = 2, dis_domain_surface = 3, dis_domain_subsurface = 4, dis_domain_space = 5
};

/* Appearance: bits that platforms of every domain share, and those of land platforms. */
enum {
    dis_appearance_damage_shift    = 3, /* two bits; 3: destroyed */
    dis_appearance_smoke_shift     = 5, /* two bits; 1: plume, 2: engine smoke, 3: both */
    dis_appearance_trail_shift     = 7, /* two bits; 0: none .. 3: large; dust, contrail or motor smoke by domain */
    dis_appearance_flaming_bit     = 15,
    dis_appearance_afterburner_bit = 16, /* air platforms */
    dis_appearance_frozen_bit      = 21,
    dis_appearance_power_plant_bit = 22,
    dis_appearance_deactivated_bit = 23,
};
enum { dis_damage_destroyed = 3 };

#endif
