# ksy sha256 86df7488bc78ce28d6591d63d2dfa669fe9622d5861d686328de2b6b7c7d97de
# This is a generated file! Please edit source .ksy file and use kaitai-struct-compiler to rebuild
# type: ignore

import kaitaistruct
from kaitaistruct import KaitaiStruct, KaitaiStream, BytesIO
from enum import IntEnum


if getattr(kaitaistruct, 'API_VERSION', (0, 9)) < (0, 11):
    raise Exception("Incompatible Kaitai Struct Python API: 0.11 or later is required, but you have %s" % (kaitaistruct.__version__))

class EnavDp(KaitaiStruct):
    """The records of one drive; SPEC_DP.md fixes every byte. Checksums are CRC-32, they are not checked
    here. The layouts below are those of content version 1; a file of another one says its own
    in its description.
    """

    class DpKind(IntEnum):
        end = 0
        init_in = 1
        init_out = 2
        set_kioz_in = 3
        set_kioz_out = 4
        process_disparity_in = 5
        process_disparity_out = 6
        analyze_terrain_in = 7
        analyze_terrain_out = 8
        select_arc_in = 9
        select_arc_out = 10
        evaluate_arc_in = 11
        evaluate_arc_out = 12
        evr = 13
        tree = 14
        surface = 15
        costmap = 16
        truth = 32
        estimate = 33
        timeline = 34
        host_evr = 35
    def __init__(self, _io, _parent=None, _root=None):
        super(EnavDp, self).__init__(_io)
        self._parent = _parent
        self._root = _root or self
        self._read()

    def _read(self):
        self.magic = self._io.read_bytes(8)
        if not self.magic == b"\x45\x4E\x41\x56\x44\x50\x0D\x0A":
            raise kaitaistruct.ValidationNotEqualError(b"\x45\x4E\x41\x56\x44\x50\x0D\x0A", self.magic, self._io, u"/seq/0")
        self.byte_order = self._io.read_bytes(4)
        self.body = EnavDp.Body(self._io, self, self._root)


    def _fetch_instances(self):
        pass
        self.body._fetch_instances()

    class Body(KaitaiStruct):
        def __init__(self, _io, _parent=None, _root=None):
            super(EnavDp.Body, self).__init__(_io)
            self._parent = _parent
            self._root = _root
            self._read()

        def _read(self):
            _on = self._root.byte_order
            if _on == b"\x04\x03\x02\x01":
                pass
                self._is_le = True
            elif _on == b"\x01\x02\x03\x04":
                pass
                self._is_le = False
            if not hasattr(self, '_is_le'):
                raise kaitaistruct.UndecidedEndiannessError("/types/body")
            elif self._is_le == True:
                self._read_le()
            elif self._is_le == False:
                self._read_be()

        def _read_le(self):
            self.format_version = self._io.read_u4le()
            if not self.format_version == 1:
                raise kaitaistruct.ValidationNotEqualError(1, self.format_version, self._io, u"/types/body/seq/0")
            self.content_version = self._io.read_u4le()
            self.description_size = self._io.read_u4le()
            if not self.description_size <= 1048576:
                raise kaitaistruct.ValidationGreaterThanError(1048576, self.description_size, self._io, u"/types/body/seq/2")
            self.description = (self._io.read_bytes(self.description_size)).decode(u"UTF-8")
            self.header_crc = self._io.read_u4le()
            self.reserved = self._io.read_u4le()
            if not self.reserved == 0:
                raise kaitaistruct.ValidationNotEqualError(0, self.reserved, self._io, u"/types/body/seq/5")
            self.records = []
            i = 0
            while not self._io.is_eof():
                self.records.append(EnavDp.Body.Record(self._io, self, self._root, self._is_le))
                i += 1


        def _read_be(self):
            self.format_version = self._io.read_u4be()
            if not self.format_version == 1:
                raise kaitaistruct.ValidationNotEqualError(1, self.format_version, self._io, u"/types/body/seq/0")
            self.content_version = self._io.read_u4be()
            self.description_size = self._io.read_u4be()
            if not self.description_size <= 1048576:
                raise kaitaistruct.ValidationGreaterThanError(1048576, self.description_size, self._io, u"/types/body/seq/2")
            self.description = (self._io.read_bytes(self.description_size)).decode(u"UTF-8")
            self.header_crc = self._io.read_u4be()
            self.reserved = self._io.read_u4be()
            if not self.reserved == 0:
                raise kaitaistruct.ValidationNotEqualError(0, self.reserved, self._io, u"/types/body/seq/5")
            self.records = []
            i = 0
            while not self._io.is_eof():
                self.records.append(EnavDp.Body.Record(self._io, self, self._root, self._is_le))
                i += 1



        def _fetch_instances(self):
            pass
            for i in range(len(self.records)):
                pass
                self.records[i]._fetch_instances()


        class EndT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.EndT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/end_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.outcome = (self._io.read_bytes_full()).decode(u"UTF-8")

            def _read_be(self):
                self.outcome = (self._io.read_bytes_full()).decode(u"UTF-8")


            def _fetch_instances(self):
                pass


        class NavAceBoundsT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavAceBoundsT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_ace_bounds_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.clearance_min_m = self._io.read_f8le()
                self.wheel_drop_max_m = self._io.read_f8le()
                self.tilt_max_rad = self._io.read_f8le()
                self.z_min_site_m = self._io.read_f8le()
                self.z_max_site_m = self._io.read_f8le()
                self.roll_min_rad = self._io.read_f8le()
                self.roll_max_rad = self._io.read_f8le()
                self.pitch_min_rad = self._io.read_f8le()
                self.pitch_max_rad = self._io.read_f8le()
                self.rocker_min_rad = self._io.read_f8le()
                self.rocker_max_rad = self._io.read_f8le()
                self.bogie_left_min_rad = self._io.read_f8le()
                self.bogie_left_max_rad = self._io.read_f8le()
                self.bogie_right_min_rad = self._io.read_f8le()
                self.bogie_right_max_rad = self._io.read_f8le()
                self.wheel_unknown = self._io.read_f8le()
                self.belly_unknown = self._io.read_f8le()
                self.reason = self._io.read_u4le()
                self.is_certified = self._io.read_u4le()

            def _read_be(self):
                self.clearance_min_m = self._io.read_f8be()
                self.wheel_drop_max_m = self._io.read_f8be()
                self.tilt_max_rad = self._io.read_f8be()
                self.z_min_site_m = self._io.read_f8be()
                self.z_max_site_m = self._io.read_f8be()
                self.roll_min_rad = self._io.read_f8be()
                self.roll_max_rad = self._io.read_f8be()
                self.pitch_min_rad = self._io.read_f8be()
                self.pitch_max_rad = self._io.read_f8be()
                self.rocker_min_rad = self._io.read_f8be()
                self.rocker_max_rad = self._io.read_f8be()
                self.bogie_left_min_rad = self._io.read_f8be()
                self.bogie_left_max_rad = self._io.read_f8be()
                self.bogie_right_min_rad = self._io.read_f8be()
                self.bogie_right_max_rad = self._io.read_f8be()
                self.wheel_unknown = self._io.read_f8be()
                self.belly_unknown = self._io.read_f8be()
                self.reason = self._io.read_u4be()
                self.is_certified = self._io.read_u4be()


            def _fetch_instances(self):
                pass


        class NavAnalyzeTerrainInT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavAnalyzeTerrainInT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_analyze_terrain_in_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.time_s = self._io.read_f8le()
                self.pose = EnavDp.Body.NavPoseT(self._io, self, self._root, self._is_le)
                self.goal = EnavDp.Body.NavWaydiscT(self._io, self, self._root, self._is_le)
                self.global_position_m = self._io.read_f8le()

            def _read_be(self):
                self.time_s = self._io.read_f8be()
                self.pose = EnavDp.Body.NavPoseT(self._io, self, self._root, self._is_le)
                self.goal = EnavDp.Body.NavWaydiscT(self._io, self, self._root, self._is_le)
                self.global_position_m = self._io.read_f8be()


            def _fetch_instances(self):
                pass
                self.pose._fetch_instances()
                self.goal._fetch_instances()


        class NavAnalyzeTerrainOutT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavAnalyzeTerrainOutT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_analyze_terrain_out_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.status = self._io.read_u4le()
                self.is_recentered = self._io.read_u4le()
                self.is_goal_inside = self._io.read_u4le()
                self.known_count = self._io.read_u4le()
                self.infinite = []
                for i in range(12):
                    self.infinite.append(self._io.read_u4le())

                self.heightmap_min_x_site_m = self._io.read_f8le()
                self.heightmap_min_y_site_m = self._io.read_f8le()
                self.costmap_min_x_site_m = self._io.read_f8le()
                self.costmap_min_y_site_m = self._io.read_f8le()

            def _read_be(self):
                self.status = self._io.read_u4be()
                self.is_recentered = self._io.read_u4be()
                self.is_goal_inside = self._io.read_u4be()
                self.known_count = self._io.read_u4be()
                self.infinite = []
                for i in range(12):
                    self.infinite.append(self._io.read_u4be())

                self.heightmap_min_x_site_m = self._io.read_f8be()
                self.heightmap_min_y_site_m = self._io.read_f8be()
                self.costmap_min_x_site_m = self._io.read_f8be()
                self.costmap_min_y_site_m = self._io.read_f8be()


            def _fetch_instances(self):
                pass
                for i in range(len(self.infinite)):
                    pass



        class NavArcT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavArcT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_arc_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.length_m = self._io.read_f8le()
                self.heading_change_rad = self._io.read_f8le()

            def _read_be(self):
                self.length_m = self._io.read_f8be()
                self.heading_change_rad = self._io.read_f8be()


            def _fetch_instances(self):
                pass


        class NavCostCellT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavCostCellT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_cost_cell_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.plane_z_site_m = self._io.read_f4le()
                self.plane_dz_dx = self._io.read_f4le()
                self.plane_dz_dy = self._io.read_f4le()
                self.tilt_rad = self._io.read_f4le()
                self.roughness_m2 = self._io.read_f4le()
                self.cost_s_per_m = self._io.read_f4le()
                self.ace_cycle = self._io.read_u4le()
                self.ace_failed_headings = self._io.read_u1()
                self.ace_reason = self._io.read_u1()
                self.terrain_reason = self._io.read_u1()
                self.is_known = self._io.read_u1()
                self.is_forbidden = self._io.read_u1()
                self.barred_headings = self._io.read_u1()
                self.pad_0 = []
                for i in range(2):
                    self.pad_0.append(self._io.read_u1())

                self.belly_obstacles = self._io.read_u4le()
                self.wheel_obstacles = self._io.read_u4le()

            def _read_be(self):
                self.plane_z_site_m = self._io.read_f4be()
                self.plane_dz_dx = self._io.read_f4be()
                self.plane_dz_dy = self._io.read_f4be()
                self.tilt_rad = self._io.read_f4be()
                self.roughness_m2 = self._io.read_f4be()
                self.cost_s_per_m = self._io.read_f4be()
                self.ace_cycle = self._io.read_u4be()
                self.ace_failed_headings = self._io.read_u1()
                self.ace_reason = self._io.read_u1()
                self.terrain_reason = self._io.read_u1()
                self.is_known = self._io.read_u1()
                self.is_forbidden = self._io.read_u1()
                self.barred_headings = self._io.read_u1()
                self.pad_0 = []
                for i in range(2):
                    self.pad_0.append(self._io.read_u1())

                self.belly_obstacles = self._io.read_u4be()
                self.wheel_obstacles = self._io.read_u4be()


            def _fetch_instances(self):
                pass
                for i in range(len(self.pad_0)):
                    pass



        class NavCostmapT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavCostmapT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_costmap_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.cell_m = self._io.read_f8le()
                self.origin_row = self._io.read_s4le()
                self.origin_col = self._io.read_s4le()
                self.is_placed = self._io.read_u4le()
                self.cycle = self._io.read_u4le()
                self.cells = []
                i = 0
                while not self._io.is_eof():
                    self.cells.append(EnavDp.Body.NavCostCellT(self._io, self, self._root, self._is_le))
                    i += 1


            def _read_be(self):
                self.cell_m = self._io.read_f8be()
                self.origin_row = self._io.read_s4be()
                self.origin_col = self._io.read_s4be()
                self.is_placed = self._io.read_u4be()
                self.cycle = self._io.read_u4be()
                self.cells = []
                i = 0
                while not self._io.is_eof():
                    self.cells.append(EnavDp.Body.NavCostCellT(self._io, self, self._root, self._is_le))
                    i += 1



            def _fetch_instances(self):
                pass
                for i in range(len(self.cells)):
                    pass
                    self.cells[i]._fetch_instances()



        class NavEvaluateArcInT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavEvaluateArcInT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_evaluate_arc_in_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.time_s = self._io.read_f8le()
                self.pose = EnavDp.Body.NavPoseT(self._io, self, self._root, self._is_le)
                self.uncertainty = EnavDp.Body.NavUncertaintyT(self._io, self, self._root, self._is_le)
                self.arc = EnavDp.Body.NavArcT(self._io, self, self._root, self._is_le)
                self.mode = self._io.read_u4le()
                self.is_leaving = self._io.read_u4le()

            def _read_be(self):
                self.time_s = self._io.read_f8be()
                self.pose = EnavDp.Body.NavPoseT(self._io, self, self._root, self._is_le)
                self.uncertainty = EnavDp.Body.NavUncertaintyT(self._io, self, self._root, self._is_le)
                self.arc = EnavDp.Body.NavArcT(self._io, self, self._root, self._is_le)
                self.mode = self._io.read_u4be()
                self.is_leaving = self._io.read_u4be()


            def _fetch_instances(self):
                pass
                self.pose._fetch_instances()
                self.uncertainty._fetch_instances()
                self.arc._fetch_instances()


        class NavEvaluateArcOutT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavEvaluateArcOutT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_evaluate_arc_out_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.status = self._io.read_u4le()
                self.is_safe = self._io.read_u4le()
                self.reason = self._io.read_u4le()
                self.failing_index = self._io.read_u4le()
                self.failing_at = self._io.read_f8le()
                self.pose_count = self._io.read_u4le()
                self.pad_0 = self._io.read_u4le()
                self.bounds = []
                i = 0
                while not self._io.is_eof():
                    self.bounds.append(EnavDp.Body.NavAceBoundsT(self._io, self, self._root, self._is_le))
                    i += 1


            def _read_be(self):
                self.status = self._io.read_u4be()
                self.is_safe = self._io.read_u4be()
                self.reason = self._io.read_u4be()
                self.failing_index = self._io.read_u4be()
                self.failing_at = self._io.read_f8be()
                self.pose_count = self._io.read_u4be()
                self.pad_0 = self._io.read_u4be()
                self.bounds = []
                i = 0
                while not self._io.is_eof():
                    self.bounds.append(EnavDp.Body.NavAceBoundsT(self._io, self, self._root, self._is_le))
                    i += 1



            def _fetch_instances(self):
                pass
                for i in range(len(self.bounds)):
                    pass
                    self.bounds[i]._fetch_instances()



        class NavEvrT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavEvrT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_evr_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.time_s = self._io.read_f8le()
                self.id = self._io.read_u4le()
                self.severity = self._io.read_u4le()
                self.arg_count = self._io.read_u4le()
                self.pad_0 = self._io.read_u4le()
                self.args = []
                for i in range(4):
                    self.args.append(self._io.read_f8le())


            def _read_be(self):
                self.time_s = self._io.read_f8be()
                self.id = self._io.read_u4be()
                self.severity = self._io.read_u4be()
                self.arg_count = self._io.read_u4be()
                self.pad_0 = self._io.read_u4be()
                self.args = []
                for i in range(4):
                    self.args.append(self._io.read_f8be())



            def _fetch_instances(self):
                pass
                for i in range(len(self.args)):
                    pass



        class NavHostEstimateT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavHostEstimateT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_host_estimate_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.time_s = self._io.read_f8le()
                self.pose = EnavDp.Body.NavPoseT(self._io, self, self._root, self._is_le)
                self.uncertainty = EnavDp.Body.NavUncertaintyT(self._io, self, self._root, self._is_le)

            def _read_be(self):
                self.time_s = self._io.read_f8be()
                self.pose = EnavDp.Body.NavPoseT(self._io, self, self._root, self._is_le)
                self.uncertainty = EnavDp.Body.NavUncertaintyT(self._io, self, self._root, self._is_le)


            def _fetch_instances(self):
                pass
                self.pose._fetch_instances()
                self.uncertainty._fetch_instances()


        class NavHostTimelineT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavHostTimelineT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_host_timeline_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.start_s = self._io.read_f8le()
                self.end_s = self._io.read_f8le()
                self.activity = self._io.read_u4le()
                self.cycle = self._io.read_u4le()
                self.arc = EnavDp.Body.NavArcT(self._io, self, self._root, self._is_le)

            def _read_be(self):
                self.start_s = self._io.read_f8be()
                self.end_s = self._io.read_f8be()
                self.activity = self._io.read_u4be()
                self.cycle = self._io.read_u4be()
                self.arc = EnavDp.Body.NavArcT(self._io, self, self._root, self._is_le)


            def _fetch_instances(self):
                pass
                self.arc._fetch_instances()


        class NavHostTruthT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavHostTruthT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_host_truth_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.time_s = self._io.read_f8le()
                self.pose = EnavDp.Body.NavPoseT(self._io, self, self._root, self._is_le)
                self.rocker_rad = self._io.read_f8le()
                self.bogie_left_rad = self._io.read_f8le()
                self.bogie_right_rad = self._io.read_f8le()
                self.tilt_rad = self._io.read_f8le()
                self.clearance_m = self._io.read_f8le()
                self.wheel_drop_m = self._io.read_f8le()
                self.slip = self._io.read_f8le()
                self.distance_driven_m = self._io.read_f8le()
                self.residual_m = self._io.read_f8le()
                self.is_converged = self._io.read_u4le()
                self.pad_0 = self._io.read_u4le()
                self.contacts = []
                i = 0
                while not self._io.is_eof():
                    self.contacts.append(EnavDp.Body.NavPointT(self._io, self, self._root, self._is_le))
                    i += 1


            def _read_be(self):
                self.time_s = self._io.read_f8be()
                self.pose = EnavDp.Body.NavPoseT(self._io, self, self._root, self._is_le)
                self.rocker_rad = self._io.read_f8be()
                self.bogie_left_rad = self._io.read_f8be()
                self.bogie_right_rad = self._io.read_f8be()
                self.tilt_rad = self._io.read_f8be()
                self.clearance_m = self._io.read_f8be()
                self.wheel_drop_m = self._io.read_f8be()
                self.slip = self._io.read_f8be()
                self.distance_driven_m = self._io.read_f8be()
                self.residual_m = self._io.read_f8be()
                self.is_converged = self._io.read_u4be()
                self.pad_0 = self._io.read_u4be()
                self.contacts = []
                i = 0
                while not self._io.is_eof():
                    self.contacts.append(EnavDp.Body.NavPointT(self._io, self, self._root, self._is_le))
                    i += 1



            def _fetch_instances(self):
                pass
                self.pose._fetch_instances()
                for i in range(len(self.contacts)):
                    pass
                    self.contacts[i]._fetch_instances()



        class NavInitInT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavInitInT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_init_in_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.time_s = self._io.read_f8le()
                self.params = []
                for i in range(58):
                    self.params.append(self._io.read_f8le())


            def _read_be(self):
                self.time_s = self._io.read_f8be()
                self.params = []
                for i in range(58):
                    self.params.append(self._io.read_f8be())



            def _fetch_instances(self):
                pass
                for i in range(len(self.params)):
                    pass



        class NavInitOutT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavInitOutT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_init_out_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.status = self._io.read_u4le()
                self.refused_index = self._io.read_u4le()

            def _read_be(self):
                self.status = self._io.read_u4be()
                self.refused_index = self._io.read_u4be()


            def _fetch_instances(self):
                pass


        class NavPathT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavPathT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_path_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.x_site_m = self._io.read_f8le()
                self.y_site_m = self._io.read_f8le()
                self.yaw_rad = self._io.read_f8le()
                self.turn = EnavDp.Body.NavArcT(self._io, self, self._root, self._is_le)
                self.first = EnavDp.Body.NavArcT(self._io, self, self._root, self._is_le)
                self.second = EnavDp.Body.NavArcT(self._io, self, self._root, self._is_le)
                self.is_kept = self._io.read_u4le()
                self.pad_0 = self._io.read_u4le()

            def _read_be(self):
                self.x_site_m = self._io.read_f8be()
                self.y_site_m = self._io.read_f8be()
                self.yaw_rad = self._io.read_f8be()
                self.turn = EnavDp.Body.NavArcT(self._io, self, self._root, self._is_le)
                self.first = EnavDp.Body.NavArcT(self._io, self, self._root, self._is_le)
                self.second = EnavDp.Body.NavArcT(self._io, self, self._root, self._is_le)
                self.is_kept = self._io.read_u4be()
                self.pad_0 = self._io.read_u4be()


            def _fetch_instances(self):
                pass
                self.turn._fetch_instances()
                self.first._fetch_instances()
                self.second._fetch_instances()


        class NavPointT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavPointT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_point_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.x_m = self._io.read_f4le()
                self.y_m = self._io.read_f4le()
                self.z_m = self._io.read_f4le()

            def _read_be(self):
                self.x_m = self._io.read_f4be()
                self.y_m = self._io.read_f4be()
                self.z_m = self._io.read_f4be()


            def _fetch_instances(self):
                pass


        class NavPoseT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavPoseT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_pose_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.x_site_m = self._io.read_f8le()
                self.y_site_m = self._io.read_f8le()
                self.z_site_m = self._io.read_f8le()
                self.roll_rad = self._io.read_f8le()
                self.pitch_rad = self._io.read_f8le()
                self.yaw_rad = self._io.read_f8le()

            def _read_be(self):
                self.x_site_m = self._io.read_f8be()
                self.y_site_m = self._io.read_f8be()
                self.z_site_m = self._io.read_f8be()
                self.roll_rad = self._io.read_f8be()
                self.pitch_rad = self._io.read_f8be()
                self.yaw_rad = self._io.read_f8be()


            def _fetch_instances(self):
                pass


        class NavProcessDisparityInT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavProcessDisparityInT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_process_disparity_in_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.time_s = self._io.read_f8le()
                self.pose = EnavDp.Body.NavPoseT(self._io, self, self._root, self._is_le)
                self.image_id = self._io.read_u4le()
                self.chunk_index = self._io.read_u4le()
                self.chunk_count = self._io.read_u4le()
                self.point_count = self._io.read_u4le()
                self.points = []
                i = 0
                while not self._io.is_eof():
                    self.points.append(EnavDp.Body.NavPointT(self._io, self, self._root, self._is_le))
                    i += 1


            def _read_be(self):
                self.time_s = self._io.read_f8be()
                self.pose = EnavDp.Body.NavPoseT(self._io, self, self._root, self._is_le)
                self.image_id = self._io.read_u4be()
                self.chunk_index = self._io.read_u4be()
                self.chunk_count = self._io.read_u4be()
                self.point_count = self._io.read_u4be()
                self.points = []
                i = 0
                while not self._io.is_eof():
                    self.points.append(EnavDp.Body.NavPointT(self._io, self, self._root, self._is_le))
                    i += 1



            def _fetch_instances(self):
                pass
                self.pose._fetch_instances()
                for i in range(len(self.points)):
                    pass
                    self.points[i]._fetch_instances()



        class NavProcessDisparityOutT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavProcessDisparityOutT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_process_disparity_out_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.status = self._io.read_u4le()
                self.merged_count = self._io.read_u4le()
                self.outside_count = self._io.read_u4le()
                self.pad_0 = self._io.read_u4le()

            def _read_be(self):
                self.status = self._io.read_u4be()
                self.merged_count = self._io.read_u4be()
                self.outside_count = self._io.read_u4be()
                self.pad_0 = self._io.read_u4be()


            def _fetch_instances(self):
                pass


        class NavSelectArcInT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavSelectArcInT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_select_arc_in_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.time_s = self._io.read_f8le()
                self.pose = EnavDp.Body.NavPoseT(self._io, self, self._root, self._is_le)
                self.uncertainty = EnavDp.Body.NavUncertaintyT(self._io, self, self._root, self._is_le)
                self.goal = EnavDp.Body.NavWaydiscT(self._io, self, self._root, self._is_le)
                self.steering = EnavDp.Body.NavSteeringT(self._io, self, self._root, self._is_le)
                self.mode = self._io.read_u4le()
                self.pad_0 = self._io.read_u4le()

            def _read_be(self):
                self.time_s = self._io.read_f8be()
                self.pose = EnavDp.Body.NavPoseT(self._io, self, self._root, self._is_le)
                self.uncertainty = EnavDp.Body.NavUncertaintyT(self._io, self, self._root, self._is_le)
                self.goal = EnavDp.Body.NavWaydiscT(self._io, self, self._root, self._is_le)
                self.steering = EnavDp.Body.NavSteeringT(self._io, self, self._root, self._is_le)
                self.mode = self._io.read_u4be()
                self.pad_0 = self._io.read_u4be()


            def _fetch_instances(self):
                pass
                self.pose._fetch_instances()
                self.uncertainty._fetch_instances()
                self.goal._fetch_instances()
                self.steering._fetch_instances()


        class NavSelectArcOutT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavSelectArcOutT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_select_arc_out_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.status = self._io.read_u4le()
                self.path_index = self._io.read_u4le()
                self.arc = EnavDp.Body.NavArcT(self._io, self, self._root, self._is_le)
                self.path_cost_s = self._io.read_f8le()
                self.cost_to_go_s = self._io.read_f8le()
                self.ace_evaluations = self._io.read_u4le()
                self.paths_tested = self._io.read_u4le()
                self.is_leaving = self._io.read_u4le()
                self.pad_0 = self._io.read_u4le()
                self.rejections = []
                for i in range(12):
                    self.rejections.append(self._io.read_u4le())

                self.bounds = EnavDp.Body.NavAceBoundsT(self._io, self, self._root, self._is_le)
                self.path_point_count = self._io.read_u4le()
                self.global_point_count = self._io.read_u4le()
                self.path_points = []
                for i in range(64):
                    self.path_points.append(EnavDp.Body.NavPointT(self._io, self, self._root, self._is_le))

                self.global_points = []
                i = 0
                while not self._io.is_eof():
                    self.global_points.append(EnavDp.Body.NavPointT(self._io, self, self._root, self._is_le))
                    i += 1


            def _read_be(self):
                self.status = self._io.read_u4be()
                self.path_index = self._io.read_u4be()
                self.arc = EnavDp.Body.NavArcT(self._io, self, self._root, self._is_le)
                self.path_cost_s = self._io.read_f8be()
                self.cost_to_go_s = self._io.read_f8be()
                self.ace_evaluations = self._io.read_u4be()
                self.paths_tested = self._io.read_u4be()
                self.is_leaving = self._io.read_u4be()
                self.pad_0 = self._io.read_u4be()
                self.rejections = []
                for i in range(12):
                    self.rejections.append(self._io.read_u4be())

                self.bounds = EnavDp.Body.NavAceBoundsT(self._io, self, self._root, self._is_le)
                self.path_point_count = self._io.read_u4be()
                self.global_point_count = self._io.read_u4be()
                self.path_points = []
                for i in range(64):
                    self.path_points.append(EnavDp.Body.NavPointT(self._io, self, self._root, self._is_le))

                self.global_points = []
                i = 0
                while not self._io.is_eof():
                    self.global_points.append(EnavDp.Body.NavPointT(self._io, self, self._root, self._is_le))
                    i += 1



            def _fetch_instances(self):
                pass
                self.arc._fetch_instances()
                for i in range(len(self.rejections)):
                    pass

                self.bounds._fetch_instances()
                for i in range(len(self.path_points)):
                    pass
                    self.path_points[i]._fetch_instances()

                for i in range(len(self.global_points)):
                    pass
                    self.global_points[i]._fetch_instances()



        class NavSetKiozInT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavSetKiozInT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_set_kioz_in_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.time_s = self._io.read_f8le()
                self.zone_count = self._io.read_u4le()
                self.pad_0 = self._io.read_u4le()
                self.zones = []
                i = 0
                while not self._io.is_eof():
                    self.zones.append(EnavDp.Body.NavZoneT(self._io, self, self._root, self._is_le))
                    i += 1


            def _read_be(self):
                self.time_s = self._io.read_f8be()
                self.zone_count = self._io.read_u4be()
                self.pad_0 = self._io.read_u4be()
                self.zones = []
                i = 0
                while not self._io.is_eof():
                    self.zones.append(EnavDp.Body.NavZoneT(self._io, self, self._root, self._is_le))
                    i += 1



            def _fetch_instances(self):
                pass
                for i in range(len(self.zones)):
                    pass
                    self.zones[i]._fetch_instances()



        class NavSetKiozOutT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavSetKiozOutT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_set_kioz_out_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.status = self._io.read_u4le()
                self.refused_index = self._io.read_u4le()

            def _read_be(self):
                self.status = self._io.read_u4be()
                self.refused_index = self._io.read_u4be()


            def _fetch_instances(self):
                pass


        class NavSteeringT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavSteeringT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_steering_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.curvature_per_m = self._io.read_f8le()
                self.in_place = self._io.read_u4le()
                self.pad_0 = self._io.read_u4le()

            def _read_be(self):
                self.curvature_per_m = self._io.read_f8be()
                self.in_place = self._io.read_u4be()
                self.pad_0 = self._io.read_u4be()


            def _fetch_instances(self):
                pass


        class NavSurfaceT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavSurfaceT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_surface_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.time_s = self._io.read_f8le()
                self.cell_m = self._io.read_f8le()
                self.origin_row = self._io.read_s4le()
                self.origin_col = self._io.read_s4le()
                self.z_site_m = []
                for i in range(90000):
                    self.z_site_m.append(self._io.read_f4le())


            def _read_be(self):
                self.time_s = self._io.read_f8be()
                self.cell_m = self._io.read_f8be()
                self.origin_row = self._io.read_s4be()
                self.origin_col = self._io.read_s4be()
                self.z_site_m = []
                for i in range(90000):
                    self.z_site_m.append(self._io.read_f4be())



            def _fetch_instances(self):
                pass
                for i in range(len(self.z_site_m)):
                    pass



        class NavTreeT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavTreeT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_tree_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.path_cost_s = []
                for i in range(1695):
                    self.path_cost_s.append(self._io.read_f8le())

                self.first_cost_s = []
                for i in range(154):
                    self.first_cost_s.append(self._io.read_f8le())

                self.kept = EnavDp.Body.NavPathT(self._io, self, self._root, self._is_le)
                self.turn_bounds = []
                for i in range(14):
                    self.turn_bounds.append(EnavDp.Body.NavAceBoundsT(self._io, self, self._root, self._is_le))

                self.first_bounds = []
                for i in range(154):
                    self.first_bounds.append(EnavDp.Body.NavAceBoundsT(self._io, self, self._root, self._is_le))

                self.order = []
                for i in range(1695):
                    self.order.append(self._io.read_u2le())

                self.path_reason = []
                for i in range(1695):
                    self.path_reason.append(self._io.read_u1())

                self.turn_verdict = []
                for i in range(14):
                    self.turn_verdict.append(self._io.read_u1())

                self.first_verdict = []
                for i in range(154):
                    self.first_verdict.append(self._io.read_u1())

                self.second_verdict = []
                for i in range(1694):
                    self.second_verdict.append(self._io.read_u1())

                self.pad_0 = []
                for i in range(5):
                    self.pad_0.append(self._io.read_u1())


            def _read_be(self):
                self.path_cost_s = []
                for i in range(1695):
                    self.path_cost_s.append(self._io.read_f8be())

                self.first_cost_s = []
                for i in range(154):
                    self.first_cost_s.append(self._io.read_f8be())

                self.kept = EnavDp.Body.NavPathT(self._io, self, self._root, self._is_le)
                self.turn_bounds = []
                for i in range(14):
                    self.turn_bounds.append(EnavDp.Body.NavAceBoundsT(self._io, self, self._root, self._is_le))

                self.first_bounds = []
                for i in range(154):
                    self.first_bounds.append(EnavDp.Body.NavAceBoundsT(self._io, self, self._root, self._is_le))

                self.order = []
                for i in range(1695):
                    self.order.append(self._io.read_u2be())

                self.path_reason = []
                for i in range(1695):
                    self.path_reason.append(self._io.read_u1())

                self.turn_verdict = []
                for i in range(14):
                    self.turn_verdict.append(self._io.read_u1())

                self.first_verdict = []
                for i in range(154):
                    self.first_verdict.append(self._io.read_u1())

                self.second_verdict = []
                for i in range(1694):
                    self.second_verdict.append(self._io.read_u1())

                self.pad_0 = []
                for i in range(5):
                    self.pad_0.append(self._io.read_u1())



            def _fetch_instances(self):
                pass
                for i in range(len(self.path_cost_s)):
                    pass

                for i in range(len(self.first_cost_s)):
                    pass

                self.kept._fetch_instances()
                for i in range(len(self.turn_bounds)):
                    pass
                    self.turn_bounds[i]._fetch_instances()

                for i in range(len(self.first_bounds)):
                    pass
                    self.first_bounds[i]._fetch_instances()

                for i in range(len(self.order)):
                    pass

                for i in range(len(self.path_reason)):
                    pass

                for i in range(len(self.turn_verdict)):
                    pass

                for i in range(len(self.first_verdict)):
                    pass

                for i in range(len(self.second_verdict)):
                    pass

                for i in range(len(self.pad_0)):
                    pass



        class NavUncertaintyT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavUncertaintyT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_uncertainty_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.position_m = self._io.read_f8le()
                self.yaw_rad = self._io.read_f8le()
                self.global_position_m = self._io.read_f8le()

            def _read_be(self):
                self.position_m = self._io.read_f8be()
                self.yaw_rad = self._io.read_f8be()
                self.global_position_m = self._io.read_f8be()


            def _fetch_instances(self):
                pass


        class NavWaydiscT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavWaydiscT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_waydisc_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.x_site_m = self._io.read_f8le()
                self.y_site_m = self._io.read_f8le()
                self.radius_m = self._io.read_f8le()

            def _read_be(self):
                self.x_site_m = self._io.read_f8be()
                self.y_site_m = self._io.read_f8be()
                self.radius_m = self._io.read_f8be()


            def _fetch_instances(self):
                pass


        class NavZoneT(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.NavZoneT, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/nav_zone_t")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.kind = self._io.read_u4le()
                self.shape = self._io.read_u4le()
                self.center_x_site_m = self._io.read_f8le()
                self.center_y_site_m = self._io.read_f8le()
                self.radius_m = self._io.read_f8le()
                self.length_m = self._io.read_f8le()
                self.width_m = self._io.read_f8le()
                self.heading_rad = self._io.read_f8le()
                self.vertex_x_site_m = []
                for i in range(3):
                    self.vertex_x_site_m.append(self._io.read_f8le())

                self.vertex_y_site_m = []
                for i in range(3):
                    self.vertex_y_site_m.append(self._io.read_f8le())


            def _read_be(self):
                self.kind = self._io.read_u4be()
                self.shape = self._io.read_u4be()
                self.center_x_site_m = self._io.read_f8be()
                self.center_y_site_m = self._io.read_f8be()
                self.radius_m = self._io.read_f8be()
                self.length_m = self._io.read_f8be()
                self.width_m = self._io.read_f8be()
                self.heading_rad = self._io.read_f8be()
                self.vertex_x_site_m = []
                for i in range(3):
                    self.vertex_x_site_m.append(self._io.read_f8be())

                self.vertex_y_site_m = []
                for i in range(3):
                    self.vertex_y_site_m.append(self._io.read_f8be())



            def _fetch_instances(self):
                pass
                for i in range(len(self.vertex_x_site_m)):
                    pass

                for i in range(len(self.vertex_y_site_m)):
                    pass



        class Record(KaitaiStruct):
            def __init__(self, _io, _parent=None, _root=None, _is_le=None):
                super(EnavDp.Body.Record, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self._is_le = _is_le
                self._read()

            def _read(self):
                if not hasattr(self, '_is_le'):
                    raise kaitaistruct.UndecidedEndiannessError("/types/body/types/record")
                elif self._is_le == True:
                    self._read_le()
                elif self._is_le == False:
                    self._read_be()

            def _read_le(self):
                self.mark = self._io.read_u4le()
                if not self.mark == 1380208197:
                    raise kaitaistruct.ValidationNotEqualError(1380208197, self.mark, self._io, u"/types/body/types/record/seq/0")
                self.kind = KaitaiStream.resolve_enum(EnavDp.DpKind, self._io.read_u4le())
                self.payload_size = self._io.read_u4le()
                self.sequence = self._io.read_u4le()
                self.time_s = self._io.read_f8le()
                self.header_crc = self._io.read_u4le()
                self.payload_crc = self._io.read_u4le()
                _on = self.kind
                if _on == EnavDp.DpKind.analyze_terrain_in:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavAnalyzeTerrainInT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.analyze_terrain_out:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavAnalyzeTerrainOutT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.costmap:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavCostmapT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.end:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.EndT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.estimate:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavHostEstimateT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.evaluate_arc_in:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavEvaluateArcInT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.evaluate_arc_out:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavEvaluateArcOutT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.evr:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavEvrT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.host_evr:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavEvrT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.init_in:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavInitInT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.init_out:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavInitOutT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.process_disparity_in:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavProcessDisparityInT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.process_disparity_out:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavProcessDisparityOutT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.select_arc_in:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavSelectArcInT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.select_arc_out:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavSelectArcOutT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.set_kioz_in:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavSetKiozInT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.set_kioz_out:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavSetKiozOutT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.surface:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavSurfaceT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.timeline:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavHostTimelineT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.tree:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavTreeT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.truth:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavHostTruthT(_io__raw_payload, self, self._root, self._is_le)
                else:
                    pass
                    self.payload = self._io.read_bytes(self.payload_size)
                self.padding = self._io.read_bytes((8 - self.payload_size % 8) % 8)

            def _read_be(self):
                self.mark = self._io.read_u4be()
                if not self.mark == 1380208197:
                    raise kaitaistruct.ValidationNotEqualError(1380208197, self.mark, self._io, u"/types/body/types/record/seq/0")
                self.kind = KaitaiStream.resolve_enum(EnavDp.DpKind, self._io.read_u4be())
                self.payload_size = self._io.read_u4be()
                self.sequence = self._io.read_u4be()
                self.time_s = self._io.read_f8be()
                self.header_crc = self._io.read_u4be()
                self.payload_crc = self._io.read_u4be()
                _on = self.kind
                if _on == EnavDp.DpKind.analyze_terrain_in:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavAnalyzeTerrainInT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.analyze_terrain_out:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavAnalyzeTerrainOutT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.costmap:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavCostmapT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.end:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.EndT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.estimate:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavHostEstimateT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.evaluate_arc_in:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavEvaluateArcInT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.evaluate_arc_out:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavEvaluateArcOutT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.evr:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavEvrT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.host_evr:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavEvrT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.init_in:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavInitInT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.init_out:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavInitOutT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.process_disparity_in:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavProcessDisparityInT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.process_disparity_out:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavProcessDisparityOutT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.select_arc_in:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavSelectArcInT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.select_arc_out:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavSelectArcOutT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.set_kioz_in:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavSetKiozInT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.set_kioz_out:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavSetKiozOutT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.surface:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavSurfaceT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.timeline:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavHostTimelineT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.tree:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavTreeT(_io__raw_payload, self, self._root, self._is_le)
                elif _on == EnavDp.DpKind.truth:
                    pass
                    self._raw_payload = self._io.read_bytes(self.payload_size)
                    _io__raw_payload = KaitaiStream(BytesIO(self._raw_payload))
                    self.payload = EnavDp.Body.NavHostTruthT(_io__raw_payload, self, self._root, self._is_le)
                else:
                    pass
                    self.payload = self._io.read_bytes(self.payload_size)
                self.padding = self._io.read_bytes((8 - self.payload_size % 8) % 8)


            def _fetch_instances(self):
                pass
                _on = self.kind
                if _on == EnavDp.DpKind.analyze_terrain_in:
                    pass
                    self.payload._fetch_instances()
                elif _on == EnavDp.DpKind.analyze_terrain_out:
                    pass
                    self.payload._fetch_instances()
                elif _on == EnavDp.DpKind.costmap:
                    pass
                    self.payload._fetch_instances()
                elif _on == EnavDp.DpKind.end:
                    pass
                    self.payload._fetch_instances()
                elif _on == EnavDp.DpKind.estimate:
                    pass
                    self.payload._fetch_instances()
                elif _on == EnavDp.DpKind.evaluate_arc_in:
                    pass
                    self.payload._fetch_instances()
                elif _on == EnavDp.DpKind.evaluate_arc_out:
                    pass
                    self.payload._fetch_instances()
                elif _on == EnavDp.DpKind.evr:
                    pass
                    self.payload._fetch_instances()
                elif _on == EnavDp.DpKind.host_evr:
                    pass
                    self.payload._fetch_instances()
                elif _on == EnavDp.DpKind.init_in:
                    pass
                    self.payload._fetch_instances()
                elif _on == EnavDp.DpKind.init_out:
                    pass
                    self.payload._fetch_instances()
                elif _on == EnavDp.DpKind.process_disparity_in:
                    pass
                    self.payload._fetch_instances()
                elif _on == EnavDp.DpKind.process_disparity_out:
                    pass
                    self.payload._fetch_instances()
                elif _on == EnavDp.DpKind.select_arc_in:
                    pass
                    self.payload._fetch_instances()
                elif _on == EnavDp.DpKind.select_arc_out:
                    pass
                    self.payload._fetch_instances()
                elif _on == EnavDp.DpKind.set_kioz_in:
                    pass
                    self.payload._fetch_instances()
                elif _on == EnavDp.DpKind.set_kioz_out:
                    pass
                    self.payload._fetch_instances()
                elif _on == EnavDp.DpKind.surface:
                    pass
                    self.payload._fetch_instances()
                elif _on == EnavDp.DpKind.timeline:
                    pass
                    self.payload._fetch_instances()
                elif _on == EnavDp.DpKind.tree:
                    pass
                    self.payload._fetch_instances()
                elif _on == EnavDp.DpKind.truth:
                    pass
                    self.payload._fetch_instances()
                else:
                    pass




