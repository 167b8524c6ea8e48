# SPDX-License-Identifier: Apache-2.0
# made by `make docs` from the tables of navlib_c/include and navlib_c/stubs: do not edit
meta:
  id: enav_dp
  title: ENav data product file
  file-extension: dp
  license: Apache-2.0
  ks-version: "0.10"
  encoding: UTF-8
doc: |
  The records of one drive; SPEC_DP.md fixes every byte. Checksums are CRC-32, they are not checked
  here. The layouts below are those of content version 1; a file of another one says its own
  in its description.
seq:
  - id: magic
    contents: [0x45, 0x4e, 0x41, 0x56, 0x44, 0x50, 0x0d, 0x0a]
  - id: byte_order
    size: 4
  - id: body
    type: body
enums:
  dp_kind:
    0: end
    1: init_in
    2: init_out
    3: set_kioz_in
    4: set_kioz_out
    5: process_disparity_in
    6: process_disparity_out
    7: analyze_terrain_in
    8: analyze_terrain_out
    9: select_arc_in
    10: select_arc_out
    11: evaluate_arc_in
    12: evaluate_arc_out
    13: evr
    14: tree
    15: surface
    16: costmap
    32: truth
    33: estimate
    34: timeline
    35: host_evr
types:
  body:
    meta:
      endian:
        switch-on: _root.byte_order
        cases:
          '[0x04, 0x03, 0x02, 0x01]': le
          '[0x01, 0x02, 0x03, 0x04]': be
    seq:
      - id: format_version
        type: u4
        valid: 1
      - id: content_version
        type: u4
      - id: description_size
        type: u4
        valid:
          max: 1048576
      - id: description
        type: str
        size: description_size
        doc: JSON, padded with spaces
      - id: header_crc
        type: u4
      - id: reserved
        type: u4
        valid: 0
      - id: records
        type: record
        repeat: eos
    types:
      record:
        seq:
          - id: mark
            type: u4
            valid: 0x52444e45
          - id: kind
            type: u4
            enum: dp_kind
          - id: payload_size
            type: u4
          - id: sequence
            type: u4
          - id: time_s
            type: f8
          - id: header_crc
            type: u4
          - id: payload_crc
            type: u4
          - id: payload
            size: payload_size
            type:
              switch-on: kind
              cases:
                dp_kind::end: end_t
                dp_kind::init_in: nav_init_in_t
                dp_kind::init_out: nav_init_out_t
                dp_kind::set_kioz_in: nav_set_kioz_in_t
                dp_kind::set_kioz_out: nav_set_kioz_out_t
                dp_kind::process_disparity_in: nav_process_disparity_in_t
                dp_kind::process_disparity_out: nav_process_disparity_out_t
                dp_kind::analyze_terrain_in: nav_analyze_terrain_in_t
                dp_kind::analyze_terrain_out: nav_analyze_terrain_out_t
                dp_kind::select_arc_in: nav_select_arc_in_t
                dp_kind::select_arc_out: nav_select_arc_out_t
                dp_kind::evaluate_arc_in: nav_evaluate_arc_in_t
                dp_kind::evaluate_arc_out: nav_evaluate_arc_out_t
                dp_kind::evr: nav_evr_t
                dp_kind::tree: nav_tree_t
                dp_kind::surface: nav_surface_t
                dp_kind::costmap: nav_costmap_t
                dp_kind::truth: nav_host_truth_t
                dp_kind::estimate: nav_host_estimate_t
                dp_kind::timeline: nav_host_timeline_t
                dp_kind::host_evr: nav_evr_t
          - id: padding
            size: (8 - payload_size % 8) % 8
      end_t:
        seq:
          - id: outcome
            type: str
            size-eos: true
            doc: JSON
      nav_pose_t:
        seq:
          - id: x_site_m
            type: f8
            doc: 'm, north'
          - id: y_site_m
            type: f8
            doc: 'm, east'
          - id: z_site_m
            type: f8
            doc: 'm, down'
          - id: roll_rad
            type: f8
            doc: 'rad, positive right side down'
          - id: pitch_rad
            type: f8
            doc: 'rad, positive nose up'
          - id: yaw_rad
            type: f8
            doc: 'rad, clockwise from north'
      nav_uncertainty_t:
        seq:
          - id: position_m
            type: f8
            doc: 'm, radius within which the true position lies, relative to the map'
          - id: yaw_rad
            type: f8
            doc: 'rad, half width of the yaw error'
          - id: global_position_m
            type: f8
            doc: 'm, radius of the position error in SITE; grows zones'
      nav_waydisc_t:
        seq:
          - id: x_site_m
            type: f8
            doc: 'm, north of the centre'
          - id: y_site_m
            type: f8
            doc: 'm, east of the centre'
          - id: radius_m
            type: f8
            doc: 'm, the goal is reached inside this radius'
      nav_arc_t:
        seq:
          - id: length_m
            type: f8
            doc: 'm, along the arc; 0 is a turn in place; negative drives backward'
          - id: heading_change_rad
            type: f8
            doc: 'rad, yaw at the end minus yaw at the start'
      nav_point_t:
        seq:
          - id: x_m
            type: f4
            doc: 'm, forward in ROVER, north in SITE'
          - id: y_m
            type: f4
            doc: 'm, right in ROVER, east in SITE'
          - id: z_m
            type: f4
            doc: 'm, down'
      nav_steering_t:
        seq:
          - id: curvature_per_m
            type: f8
            doc: '1/m, heading change per metre, positive clockwise; 0 in place'
          - id: in_place
            type: u4
            doc: '1 when steered for a turn in place'
          - id: pad_0
            type: u4
            doc: 'zero'
      nav_zone_t:
        seq:
          - id: kind
            type: u4
            doc: 'nav_zone_kind_t'
          - id: shape
            type: u4
            doc: 'nav_zone_shape_t'
          - id: center_x_site_m
            type: f8
            doc: 'm, circle, rectangle: north of the centre'
          - id: center_y_site_m
            type: f8
            doc: 'm, circle, rectangle: east of the centre'
          - id: radius_m
            type: f8
            doc: 'm, circle'
          - id: length_m
            type: f8
            doc: 'm, rectangle: along its heading'
          - id: width_m
            type: f8
            doc: 'm, rectangle: across its heading'
          - id: heading_rad
            type: f8
            doc: 'rad, rectangle: clockwise from north'
          - id: vertex_x_site_m
            type: f8
            repeat: expr
            repeat-expr: 3
            doc: 'm, triangle: north of its corners, in either sense'
          - id: vertex_y_site_m
            type: f8
            repeat: expr
            repeat-expr: 3
            doc: 'm, triangle: east of its corners'
      nav_cost_cell_t:
        seq:
          - id: plane_z_site_m
            type: f4
            doc: 'm, height of the fitted plane at the centre, down'
          - id: plane_dz_dx
            type: f4
            doc: 'plane: z down per metre north'
          - id: plane_dz_dy
            type: f4
            doc: 'plane: z down per metre east'
          - id: tilt_rad
            type: f4
            doc: 'rad, tilt of the plane'
          - id: roughness_m2
            type: f4
            doc: 'm^2, mean squared residual to the plane'
          - id: cost_s_per_m
            type: f4
            doc: 's/m, time and terrain, per metre driven'
          - id: ace_cycle
            type: u4
            doc: 'analysis in which ACE last failed here'
          - id: ace_failed_headings
            type: u1
            doc: 'bit k: ACE failed last along heading k * 45 deg or back'
          - id: ace_reason
            type: u1
            doc: 'nav_reason_t of its last failure'
          - id: terrain_reason
            type: u1
            doc: 'nav_reason_t: tilt, unexpected, or none'
          - id: is_known
            type: u1
            doc: '1 when a plane has been fitted'
          - id: is_forbidden
            type: u1
            doc: '1 when zones forbid it'
          - id: barred_headings
            type: u1
            doc: 'bit k: obstacles under a rover that stands so'
          - id: pad_0
            type: u1
            repeat: expr
            repeat-expr: 2
            doc: 'zero'
          - id: belly_obstacles
            type: u4
            doc: 'bit 5 * row + column: too high for the belly'
          - id: wheel_obstacles
            type: u4
            doc: 'the same: too high or too deep for a wheel'
      nav_ace_bounds_t:
        seq:
          - id: clearance_min_m
            type: f8
            doc: 'm, lower bound of belly clearance along the body z axis'
          - id: wheel_drop_max_m
            type: f8
            doc: 'm, upper bound of the height span in a wheel''s box'
          - id: tilt_max_rad
            type: f8
            doc: 'rad, upper bound of the tilt against gravity'
          - id: z_min_site_m
            type: f8
            doc: 'm, highest the ROVER origin can be (z is down)'
          - id: z_max_site_m
            type: f8
            doc: 'm, lowest the ROVER origin can be'
          - id: roll_min_rad
            type: f8
            doc: 'rad'
          - id: roll_max_rad
            type: f8
            doc: 'rad'
          - id: pitch_min_rad
            type: f8
            doc: 'rad'
          - id: pitch_max_rad
            type: f8
            doc: 'rad'
          - id: rocker_min_rad
            type: f8
            doc: 'rad, left rocker'
          - id: rocker_max_rad
            type: f8
            doc: 'rad, left rocker'
          - id: bogie_left_min_rad
            type: f8
            doc: 'rad'
          - id: bogie_left_max_rad
            type: f8
            doc: 'rad'
          - id: bogie_right_min_rad
            type: f8
            doc: 'rad'
          - id: bogie_right_max_rad
            type: f8
            doc: 'rad'
          - id: wheel_unknown
            type: f8
            doc: 'largest unknown share of a wheel box'
          - id: belly_unknown
            type: f8
            doc: 'unknown share of the belly box'
          - id: reason
            type: u4
            doc: 'nav_reason_t: NONE when every bound is within its limit'
          - id: is_certified
            type: u4
            doc: '1 when the bounds are consistent with the growth they assume'
      nav_evr_t:
        seq:
          - id: time_s
            type: f8
            doc: 's, time of the call that reported it'
          - id: id
            type: u4
            doc: 'nav_evr_id_t'
          - id: severity
            type: u4
            doc: 'nav_evr_severity_t'
          - id: arg_count
            type: u4
            doc: 'arguments used'
          - id: pad_0
            type: u4
            doc: 'zero'
          - id: args
            type: f8
            repeat: expr
            repeat-expr: 4
            doc: 'arguments in the order of the text'
      nav_init_in_t:
        seq:
          - id: time_s
            type: f8
            doc: 's'
          - id: params
            type: f8
            repeat: expr
            repeat-expr: 58
            doc: 'nav_params_t, in the order of its table'
      nav_init_out_t:
        seq:
          - id: status
            type: u4
            doc: 'nav_status_t'
          - id: refused_index
            type: u4
            doc: 'parameter refused, or the number of parameters'
      nav_set_kioz_in_t:
        seq:
          - id: time_s
            type: f8
            doc: 's'
          - id: zone_count
            type: u4
            doc: 'zones used'
          - id: pad_0
            type: u4
            doc: 'zero'
          - id: zones
            type: nav_zone_t
            repeat: eos
            doc: 'recorded to zone_count'
      nav_set_kioz_out_t:
        seq:
          - id: status
            type: u4
            doc: 'nav_status_t'
          - id: refused_index
            type: u4
            doc: 'zone refused, or zone_count'
      nav_process_disparity_in_t:
        seq:
          - id: time_s
            type: f8
            doc: 's, of the imaging'
          - id: pose
            type: nav_pose_t
            doc: 'estimated pose at the imaging'
          - id: image_id
            type: u4
            doc: 'one number for all chunks of an image, never used again'
          - id: chunk_index
            type: u4
            doc: '0 to chunk_count - 1, in order'
          - id: chunk_count
            type: u4
            doc: 'at least 1'
          - id: point_count
            type: u4
            doc: 'points used'
          - id: points
            type: nav_point_t
            repeat: eos
            doc: 'ROVER at the pose; recorded to point_count'
      nav_process_disparity_out_t:
        seq:
          - id: status
            type: u4
            doc: 'nav_status_t'
          - id: merged_count
            type: u4
            doc: 'points merged'
          - id: outside_count
            type: u4
            doc: 'points outside the map'
          - id: pad_0
            type: u4
            doc: 'zero'
      nav_analyze_terrain_in_t:
        seq:
          - id: time_s
            type: f8
            doc: 's'
          - id: pose
            type: nav_pose_t
            doc: 'estimated pose now'
          - id: goal
            type: nav_waydisc_t
          - id: global_position_m
            type: f8
            doc: 'm, position uncertainty in SITE: grows zones'
      nav_analyze_terrain_out_t:
        seq:
          - id: status
            type: u4
            doc: 'nav_status_t'
          - id: is_recentered
            type: u4
            doc: '1 when the costmap was recentred'
          - id: is_goal_inside
            type: u4
            doc: '1 when the goal lies on the costmap'
          - id: known_count
            type: u4
            doc: 'costmap cells with a plane'
          - id: infinite
            type: u4
            repeat: expr
            repeat-expr: 12
            doc: 'costmap cells by nav_reason_t'
          - id: heightmap_min_x_site_m
            type: f8
            doc: 'm, south edge of the heightmap'
          - id: heightmap_min_y_site_m
            type: f8
            doc: 'm, west edge of the heightmap'
          - id: costmap_min_x_site_m
            type: f8
            doc: 'm, south edge of the costmap'
          - id: costmap_min_y_site_m
            type: f8
            doc: 'm, west edge of the costmap'
      nav_select_arc_in_t:
        seq:
          - id: time_s
            type: f8
            doc: 's'
          - id: pose
            type: nav_pose_t
            doc: 'predicted pose at the end of the current arc'
          - id: uncertainty
            type: nav_uncertainty_t
            doc: 'at that pose'
          - id: goal
            type: nav_waydisc_t
          - id: steering
            type: nav_steering_t
            doc: 'of the current arc'
          - id: mode
            type: u4
            doc: 'nav_mode_t'
          - id: pad_0
            type: u4
            doc: 'zero'
      nav_select_arc_out_t:
        seq:
          - id: status
            type: u4
            doc: 'nav_status_t: OK or NO_PATH'
          - id: path_index
            type: u4
            doc: 'selected; 1694 rest of the last path, 1695.. first arcs, 1849.. back'
          - id: arc
            type: nav_arc_t
            doc: 'what to drive next'
          - id: path_cost_s
            type: f8
            doc: 's, of the selected path'
          - id: cost_to_go_s
            type: f8
            doc: 's, from its end to the goal, part of path_cost_s'
          - id: ace_evaluations
            type: u4
            doc: 'ACE poses evaluated in this call'
          - id: paths_tested
            type: u4
          - id: is_leaving
            type: u4
            doc: '1 when only the leave limits let a path pass'
          - id: pad_0
            type: u4
            doc: 'zero'
          - id: rejections
            type: u4
            repeat: expr
            repeat-expr: 12
            doc: 'candidates by nav_reason_t'
          - id: bounds
            type: nav_ace_bounds_t
            doc: 'worst of each bound along the selected path'
          - id: path_point_count
            type: u4
          - id: global_point_count
            type: u4
          - id: path_points
            type: nav_point_t
            repeat: expr
            repeat-expr: 64
            doc: 'local path, SITE, z 0'
          - id: global_points
            type: nav_point_t
            repeat: eos
            doc: 'from its end to the goal, SITE, z 0'
      nav_evaluate_arc_in_t:
        seq:
          - id: time_s
            type: f8
            doc: 's'
          - id: pose
            type: nav_pose_t
            doc: 'where the arc starts'
          - id: uncertainty
            type: nav_uncertainty_t
            doc: 'at that pose'
          - id: arc
            type: nav_arc_t
            doc: 'any length up to 10 m either way, or a turn in place'
          - id: mode
            type: u4
            doc: 'nav_mode_t: which checks to make'
          - id: is_leaving
            type: u4
            doc: '1 for an arc that select_arc passed by the leave limits'
      nav_evaluate_arc_out_t:
        seq:
          - id: status
            type: u4
            doc: 'nav_status_t'
          - id: is_safe
            type: u4
            doc: '1 when no pose fails'
          - id: reason
            type: u4
            doc: 'nav_reason_t of the first failing pose'
          - id: failing_index
            type: u4
            doc: 'first failing pose, or pose_count'
          - id: failing_at
            type: f8
            doc: 'm or rad, its distance along the arc, its angle in a turn in place'
          - id: pose_count
            type: u4
          - id: pad_0
            type: u4
            doc: 'zero'
          - id: bounds
            type: nav_ace_bounds_t
            repeat: eos
            doc: 'margins along the arc; to pose_count'
      nav_path_t:
        seq:
          - id: x_site_m
            type: f8
            doc: 'm, expected start'
          - id: y_site_m
            type: f8
            doc: 'm, expected start'
          - id: yaw_rad
            type: f8
            doc: 'rad, expected start'
          - id: turn
            type: nav_arc_t
            doc: 'turn in place'
          - id: first
            type: nav_arc_t
          - id: second
            type: nav_arc_t
          - id: is_kept
            type: u4
            doc: '1 when there is such a path'
          - id: pad_0
            type: u4
            doc: 'zero'
      nav_tree_t:
        seq:
          - id: path_cost_s
            type: f8
            repeat: expr
            repeat-expr: 1695
            doc: 's, 1e12 when it crosses an infinite cell'
          - id: first_cost_s
            type: f8
            repeat: expr
            repeat-expr: 154
            doc: 's, of a first arc alone'
          - id: kept
            type: nav_path_t
            doc: 'what is left of the selected path'
          - id: turn_bounds
            type: nav_ace_bounds_t
            repeat: expr
            repeat-expr: 14
            doc: 'worst bounds along a tested turn'
          - id: first_bounds
            type: nav_ace_bounds_t
            repeat: expr
            repeat-expr: 154
            doc: 'worst bounds to the end of it'
          - id: order
            type: u2
            repeat: expr
            repeat-expr: 1695
            doc: 'paths by rising cost, then index; kept last'
          - id: path_reason
            type: u1
            repeat: expr
            repeat-expr: 1695
            doc: 'nav_reason_t'
          - id: turn_verdict
            type: u1
            repeat: expr
            repeat-expr: 14
            doc: 'nav_reason_t of a turn, 255 untested'
          - id: first_verdict
            type: u1
            repeat: expr
            repeat-expr: 154
            doc: 'of a first arc'
          - id: second_verdict
            type: u1
            repeat: expr
            repeat-expr: 1694
            doc: 'of a second arc'
          - id: pad_0
            type: u1
            repeat: expr
            repeat-expr: 5
            doc: 'zero'
      nav_surface_t:
        seq:
          - id: time_s
            type: f8
            doc: 's, when it was made'
          - id: cell_m
            type: f8
            doc: 'm, side of a cell'
          - id: origin_row
            type: s4
            doc: 'global index of the southernmost row'
          - id: origin_col
            type: s4
            doc: 'global index of the westernmost column'
          - id: z_site_m
            type: f4
            repeat: expr
            repeat-expr: 90000
            doc: 'm, down, row by row from south; 1e9 where unknown'
      nav_costmap_t:
        seq:
          - id: cell_m
            type: f8
            doc: 'm, side of a cell'
          - id: origin_row
            type: s4
            doc: 'global index of the southernmost row, in costmap cells'
          - id: origin_col
            type: s4
            doc: 'global index of the westernmost column'
          - id: is_placed
            type: u4
            doc: '0 until first centred'
          - id: cycle
            type: u4
            doc: 'analyses so far'
          - id: cells
            type: nav_cost_cell_t
            repeat: eos
            doc: 'row by row from south'
      nav_host_truth_t:
        seq:
          - id: time_s
            type: f8
            doc: 's'
          - id: pose
            type: nav_pose_t
            doc: 'of the settled rover'
          - id: rocker_rad
            type: f8
            doc: 'rad, left rocker, nose down positive'
          - id: bogie_left_rad
            type: f8
            doc: 'rad, against its rocker, nose down positive'
          - id: bogie_right_rad
            type: f8
            doc: 'rad, against its rocker, nose down positive'
          - id: tilt_rad
            type: f8
            doc: 'rad, against gravity'
          - id: clearance_m
            type: f8
            doc: 'm, belly pan to terrain along the body z axis'
          - id: wheel_drop_m
            type: f8
            doc: 'm, largest height span in a wheel''s footprint'
          - id: slip
            type: f8
            doc: '1 - actual / commanded motion along the arc'
          - id: distance_driven_m
            type: f8
            doc: 'm, since the start'
          - id: residual_m
            type: f8
            doc: 'm, largest gap left between a wheel and the ground'
          - id: is_converged
            type: u4
            doc: '1 when the settling met its tolerance'
          - id: pad_0
            type: u4
            doc: 'zero'
          - id: contacts
            type: nav_point_t
            repeat: eos
            doc: 'wheel contact points, SITE'
      nav_host_estimate_t:
        seq:
          - id: time_s
            type: f8
            doc: 's'
          - id: pose
            type: nav_pose_t
            doc: 'what the rover believes'
          - id: uncertainty
            type: nav_uncertainty_t
      nav_host_timeline_t:
        seq:
          - id: start_s
            type: f8
            doc: 's'
          - id: end_s
            type: f8
            doc: 's'
          - id: activity
            type: u4
            doc: 'nav_host_activity_t'
          - id: cycle
            type: u4
            doc: 'planning cycle it belongs to'
          - id: arc
            type: nav_arc_t
            doc: 'of steering, driving, selecting, evaluating; else 0'
