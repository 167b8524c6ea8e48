/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_places.h
 * @brief Used by ACE alone: where the parts of a rover can be while its wheel heights lie within intervals.
 *
 * In the plane frame of nav_ground.h. Places are taken straight from the six wheel heights, in which
 * they are nearly linear, not from the states of the linkage: what moves a wheel fore and aft cancels in
 * part between pitch, rocker and bogie.
 */
#ifndef NAV_PLACES_H
#define NAV_PLACES_H

#include "nav_arc.h"
#include "nav_ground.h"
#include "nav_vehicle.h"

/** How far parts of the rover can be from where they nominally are in the plane. */
typedef struct
{
    double turn; /* half width of the turn in the plane */
    double bend; /* second-order share of turning */
    double u_m;  /* of a part at the origin */
    double v_m;
    double box_turn; /* how far a wheel and its box can be turned from the heading */
} nav_reach_t;

/** Where the wheels can be, and how the body leans meanwhile. */
typedef struct
{
    nav_box_t wheels[NAV_WHEELS]; /* hubs fore and aft, what they touch sideways */
    double height_m[NAV_WHEELS];  /* in the middle */
    double roll_rad;              /* relative to the plane, in the middle */
    double roll_half_rad;
    double pitch_rad;
    double pitch_half_rad;
    nav_reach_t reach;
    bool is_bounded; /* false: the heights are too different for bounds of the places */
} nav_places_t;

/** The turn in the plane that keeps a pitched rover's yaw, which is measured in the horizontal. */
double nav_places_turn(const nav_ground_t *ground, double pitch_rad);

/** @param height_half_m, pitch_half_rad  half widths of what the ROVER origin's height and the pitch can be */
nav_reach_t nav_places_reach(const nav_ground_t *ground,
                             const nav_uncertainty_t *uncertainty,
                             double height_half_m,
                             double pitch_rad,
                             double pitch_half_rad);

/** Widens a box around a part of the rover by how far it can be from its place. */
void nav_places_grow(const nav_reach_t *reach, double u_m, double v_m, nav_box_t *box);

/** The places that follow from intervals of the six wheel heights. */
void nav_places_find(const nav_ground_t *ground,
                     const nav_vehicle_t *vehicle,
                     const nav_uncertainty_t *uncertainty,
                     const nav_interval_t heights[NAV_WHEELS],
                     nav_places_t *places);

/** Does a box lie inside another one? */
bool nav_places_cover(const nav_box_t *outer, const nav_box_t *inner);

/** Do all places of the wheels lie inside others? */
bool nav_places_hold(const nav_places_t *outer, const nav_places_t *inner);

#endif
