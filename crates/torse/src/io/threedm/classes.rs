//! The classes of objects by their identifiers, those of older programs included.

use super::bytes::Uuid;

/// What an object is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Class {
    NurbsCurve,
    LineCurve,
    ArcCurve,
    PolylineCurve,
    PolyCurve,
    NurbsSurface,
    PlaneSurface,
    RevSurface,
    SumSurface,
    Brep,
    Extrusion,
    Mesh,
    SubD,
    InstanceRef,
    Point,
    Dot,
    /// Another class.
    Other(Uuid),
}

/// The identifier with the first half `head`; many end alike.
const fn early(head: u64) -> Uuid {
    Uuid::of((head as u128) << 64 | 0xBFE5_0010_8301_22F0)
}

const NAMED: [(Uuid, Class); 26] = [
    (early(0x4ED7_D4DD_E947_11D3), Class::NurbsCurve),
    (Uuid::of(0x5EAF_1119_0B51_11D4_BFFE_0010_8301_22F0), Class::NurbsCurve),
    (Uuid::of(0x76A7_09D5_1550_11D4_8000_0010_8301_22F0), Class::NurbsCurve),
    (early(0x4ED7_D4DB_E947_11D3), Class::LineCurve),
    (Uuid::of(0xCF33_BE2A_09B4_11D4_BFFB_0010_8301_22F0), Class::ArcCurve),
    (early(0x4ED7_D4E6_E947_11D3), Class::PolylineCurve),
    (early(0x4ED7_D4E0_E947_11D3), Class::PolyCurve),
    (Uuid::of(0xEF63_8317_154B_11D4_8000_0010_8301_22F0), Class::PolyCurve),
    (early(0x4ED7_D4DE_E947_11D3), Class::NurbsSurface),
    (Uuid::of(0x4760_C817_0BE3_11D4_BFFE_0010_8301_22F0), Class::NurbsSurface),
    (Uuid::of(0xFA4F_D4B5_1613_11D4_8000_0010_8301_22F0), Class::NurbsSurface),
    (early(0x4ED7_D4DF_E947_11D3), Class::PlaneSurface),
    (Uuid::of(0xA162_20D3_163B_11D4_8000_0010_8301_22F0), Class::RevSurface),
    (Uuid::of(0x0A84_01B6_4D34_4B99_8615_1B4E_723D_C4E5), Class::RevSurface),
    (Uuid::of(0xC4CD_5359_446D_4690_9FF5_2905_9732_472B), Class::SumSurface),
    (Uuid::of(0x665F_6331_2A66_4CCE_81D0_B5EE_BD9B_5417), Class::SumSurface),
    (Uuid::of(0x60B5_DBC5_E660_11D3_BFE4_0010_8301_22F0), Class::Brep),
    (Uuid::of(0x0705_FDEF_3E2A_11D4_800E_0010_8301_22F0), Class::Brep),
    (Uuid::of(0x2D4C_FEDB_3E2A_11D4_800E_0010_8301_22F0), Class::Brep),
    (Uuid::of(0xF06F_C243_A32A_4608_9DD8_A7D2_C4CE_2A36), Class::Brep),
    (Uuid::of(0x36F5_3175_72B8_4D47_BF1F_B4E6_FC24_F4B9), Class::Extrusion),
    (early(0x4ED7_D4E4_E947_11D3), Class::Mesh),
    (Uuid::of(0xF09B_A4D9_455B_42C3_BA3B_E6CC_ACEF_853B), Class::SubD),
    (Uuid::of(0xF9CF_B638_B9D4_4340_87E3_C56E_7865_D96A), Class::InstanceRef),
    (Uuid::of(0xC310_1A1D_F157_11D3_BFE7_0010_8301_22F0), Class::Point),
    (Uuid::of(0x7419_8302_CDF4_4F95_9609_6D68_4F22_AB37), Class::Dot),
];

impl Class {
    /// The class with this identifier.
    pub fn of(id: Uuid) -> Self {
        NAMED.iter().find(|(known, _)| *known == id).map_or(Self::Other(id), |n| n.1)
    }

    /// Whether an object of this class is a curve.
    pub fn is_curve(self) -> bool {
        use Class::{ArcCurve, LineCurve, NurbsCurve, PolyCurve, PolylineCurve};
        matches!(self, NurbsCurve | LineCurve | ArcCurve | PolylineCurve | PolyCurve)
    }

    /// Whether an object of this class has faces that are read.
    pub fn has_faces(self) -> bool {
        use Class::{Brep, Extrusion, NurbsSurface, PlaneSurface, RevSurface, SumSurface};
        matches!(self, Brep | Extrusion | NurbsSurface | PlaneSurface | RevSurface | SumSurface)
    }

    /// What people call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::NurbsCurve | Self::LineCurve | Self::ArcCurve | Self::PolylineCurve | Self::PolyCurve => "curve",
            Self::NurbsSurface | Self::PlaneSurface | Self::RevSurface | Self::SumSurface => "surface",
            Self::Brep => "polysurface",
            Self::Extrusion => "extrusion",
            Self::Mesh => "mesh",
            Self::SubD => "SubD",
            Self::InstanceRef => "block",
            Self::Point => "point",
            Self::Dot => "text dot",
            Self::Other(_) => "object",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn older_identifiers_mean_the_same_classes() {
        for (id, class) in [
            (0x60B5_DBC5_E660_11D3_BFE4_0010_8301_22F0, Class::Brep),
            (0xF06F_C243_A32A_4608_9DD8_A7D2_C4CE_2A36, Class::Brep),
            (0x5EAF_1119_0B51_11D4_BFFE_0010_8301_22F0, Class::NurbsCurve),
        ] {
            assert_eq!(Class::of(Uuid::of(id)), class);
        }
        assert_eq!(Class::of(Uuid::of(5)), Class::Other(Uuid::of(5)));
    }
}
