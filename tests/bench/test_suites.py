"""Cases of code_aster and FEBio: small ones written here are read and have the answers that theory gives."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "bench" / "suites"))
import aster
import febio
from aster_commands import commands
from aster_mesh import read_mail
from aster_model import read_case
from febio_model import read_model
from foreign_mesh import NotReadable, in_order

from abut.mesh.reference import reference_nodes

# Two squares of side 1, one on the other, of which the upper one is numbered clockwise.
MAIL = """
 COOR_2D
 N1 0. 0.   N2 1. 0.   N3 1. 1.D0  N4 0. 1.
 N5 0. 1.   N6 1. 1.   N7 1. 2.    N8 0. 2.
 FINSF
 QUAD4
 M1 N1 N2 N3 N4
 M2 N5 N8 N7 N6
 FINSF
 SEG2
 S1 N3 N4
 S2 N5 N6
 S3 N7 N8
 FINSF
 GROUP_MA NOM = MAIT
 S1
 FINSF
 GROUP_MA
 ESCL S2
 FINSF
 GROUP_MA NOM=HAUT
 S3
 FINSF
 FIN
"""
COMM = """
DEBUT()
MA = LIRE_MAILLAGE(FORMAT="ASTER")
MA = DEFI_GROUP(reuse=MA, MAILLAGE=MA, CREA_GROUP_NO=(
    _F(OPTION="PLAN", NOM="BAS", POINT=(0.0, 0.0), VECT_NORMALE=(0.0, 1.0), PRECISION=1e-6), _F(NOM="P", NOEUD="N7")))
young = 2.0 * 50
MO = AFFE_MODELE(MAILLAGE=MA, AFFE=_F(TOUT="OUI", PHENOMENE="MECANIQUE", MODELISATION="C_PLAN"))
MAT = DEFI_MATERIAU(ELAS=_F(E=young, NU=0.0))
CM = AFFE_MATERIAU(MAILLAGE=MA, AFFE=_F(TOUT="OUI", MATER=MAT))
CH = AFFE_CHAR_MECA(MODELE=MO, DDL_IMPO=(_F(GROUP_NO="BAS", DX=0.0, DY=0.0), _F(GROUP_NO="P", DX=0.0)),
                    PRES_REP=_F(GROUP_MA="HAUT", PRES=10.0))
CO = DEFI_CONTACT(MODELE=MO, FORMULATION="CONTINUE", ZONE=_F(GROUP_MA_MAIT="MAIT", GROUP_MA_ESCL="ESCL"))
F = DEFI_FONCTION(NOM_PARA="INST", VALE=(0.0, 0.0, 2.0, 1.0))
L = DEFI_LIST_REEL(DEBUT=0.0, INTERVALLE=_F(JUSQU_A=2.0, NOMBRE=4))
U = STAT_NON_LINE(MODELE=MO, CHAM_MATER=CM, EXCIT=_F(CHARGE=CH, FONC_MULT=F), CONTACT=CO,
                  COMPORTEMENT=_F(RELATION="ELAS"), INCREMENT=_F(LIST_INST=L))
TEST_RESU(RESU=(
    _F(RESULTAT=U, NOM_CHAM="DEPL", GROUP_NO="P", NOM_CMP="DY", INST=1.0, VALE_CALC=-0.1),
    _F(RESULTAT=U, NOM_CHAM="DEPL", NOEUD="N7", NOM_CMP="DY", INST=2.0, VALE_CALC=-0.2, VALE_REFE=-0.2),
    _F(RESULTAT=U, NOM_CHAM="DEPL", NOEUD="N5", NOM_CMP="LAGS_C", INST=2.0, VALE_CALC=-10.0)))
FIN()
"""


def written(folder: Path, comm: str = COMM) -> Path:
    (folder / "case.mail").write_text(MAIL)
    (folder / "case.comm").write_text(comm)
    return folder / "case.comm"


def test_a_case_of_code_aster(tmp_path: Path) -> None:
    """Two squares under a pressure of 10, E = 100 without Poisson's ratio: each gives way by a tenth, at half of the time by
    half of it."""
    (found,) = aster.outcomes(written(tmp_path), 30.0)
    assert (found.status, found.kinematics, found.tests) == ("solved", "small-strain", 3)
    assert np.nanmax(found.errors) < 1e-9
    assert np.isnan(found.errors).tolist() == [False, False, False, True]


def test_a_rigid_target_of_facets_alone(tmp_path: Path) -> None:
    """Without the lower square its upper side, held, is a rigid one: only the upper square gives way."""
    mail = MAIL.replace(" M1 N1 N2 N3 N4\n", "")
    comm = COMM.replace('GROUP_NO="BAS", DX=0.0', 'GROUP_MA="MAIT", DX=0.0').replace(
        "VALE_CALC=-0.1)", "VALE_CALC=-0.05)"
    )
    path = written(tmp_path, comm.replace("=-0.2", "=-0.1"))
    path.with_suffix(".mail").write_text(mail)
    (found,) = aster.outcomes(path, 30.0)
    assert found.status == "solved"
    assert found.errors[0] < 1e-9


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('"ELAS"', '"VMIS_ISOT_LINE"', "COMPORTEMENT VMIS_ISOT_LINE"),
        ("C_PLAN", "DKT", "MODELISATION DKT"),
        ("FIN()", "for i in range(2):\n    AFFE_CHAR_MECA()", "for, which is not run here"),
        ("PRES_REP=_F(", "LIAISON_SOLIDE=_F(", "LIAISON_SOLIDE"),
        ("NU=0.0", "NU=poisson", "no isotropic elasticity in numbers"),
    ],
)
def test_what_is_not_read_says_why(old: str, new: str, says: str, tmp_path: Path) -> None:
    with pytest.raises(NotReadable, match=says):
        read_case(written(tmp_path, COMM.replace(old, new)))


def test_command_files_are_not_run(tmp_path: Path) -> None:
    """Calls that are no commands are nothing known."""
    found = commands(
        f"x = open({str(tmp_path / 'made')!r}, 'w')\nA = DEFI_CONSTANTE(VALE=x)\nB = DEFI_CONSTANTE(VALE=-2.0 ** 2)"
    )
    assert not (tmp_path / "made").exists()
    assert type(found[0]["VALE"]).__name__ == "Unknown"
    assert found[1]["VALE"] == -4.0


def test_nodes_in_any_order() -> None:
    """Corners the other way round and mid-nodes in another order: the same cells, of positive volume."""
    mesh = read_mail(MAIL)
    nodes = in_order("quad4", mesh.parts[0].nodes, mesh.points)
    x = mesh.points[nodes]
    assert (np.linalg.det(np.stack([x[:, 1] - x[:, 0], x[:, 3] - x[:, 0]], axis=1)) > 0.0).all()
    for kind, shuffled in (
        ("hex20", [*range(8), *reversed(range(8, 20))]),
        ("wedge15", [*range(6), *range(14, 5, -1)]),
    ):
        places = reference_nodes(kind)
        assert in_order(kind, np.array([shuffled]), places)[0].tolist() == list(range(len(places)))


NODES = [(x, y, z) for z in (0, 1, 1, 2) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
FEB = f"""<?xml version="1.0"?>
<febio_spec version="4.0"><Module type="solid"/>
<Control><analysis>STATIC</analysis><time_steps>10</time_steps><step_size>0.2</step_size></Control>
<Material><material id="1" name="soft" type="neo-Hookean"><E>100</E><v>0</v></material>
<material id="2" name="hard" type="rigid body"><density>1</density></material></Material>
<Mesh><Nodes name="all">{"".join(f'<node id="{i + 1}">{x},{y},{z}</node>' for i, (x, y, z) in enumerate(NODES))}</Nodes>
<Elements type="hex8" name="low"><elem id="1">1,2,3,4,5,6,7,8</elem></Elements>
<Elements type="hex8" name="high"><elem id="2">9,10,11,12,13,14,15,16</elem></Elements>
<NodeSet name="bottom">1,2,3,4</NodeSet><NodeSet name="sides">1,2,3,4,5,6,7,8</NodeSet>
<Surface name="a"><quad4 id="1">5,6,7,8</quad4></Surface><Surface name="b"><quad4 id="1">9,12,11,10</quad4></Surface>
<SurfacePair name="pair"><primary>a</primary><secondary>b</secondary></SurfacePair></Mesh>
<MeshDomains><SolidDomain name="low" mat="soft"/><SolidDomain name="high" mat="hard"/></MeshDomains>
<Boundary><bc node_set="bottom" type="zero displacement"><z_dof>1</z_dof></bc>
<bc node_set="sides" type="zero displacement"><x_dof>1</x_dof><y_dof>1</y_dof></bc></Boundary>
<Rigid><rigid_bc type="rigid_fixed"><rb>hard</rb><Rx_dof>1</Rx_dof><Ry_dof>1</Ry_dof><Ru_dof>1</Ru_dof><Rv_dof>1</Rv_dof>
<Rw_dof>1</Rw_dof></rigid_bc>
<rigid_bc type="rigid_displacement"><rb>hard</rb><dof>z</dof><value lc="1">-0.1</value></rigid_bc>
</Rigid>
<Contact><contact name="pair" surface_pair="pair" type="sliding-elastic"><fric_coeff>0</fric_coeff></contact></Contact>
<LoadData><load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate><points><pt>0,0</pt><pt>2,3</pt></points>
</load_controller></LoadData>
<Output><logfile><node_data data="ux;uy;uz" file="moved.txt"/></logfile></Output></febio_spec>
"""


def test_a_case_of_febio(tmp_path: Path) -> None:
    """A cube pressed to J = 0.7 by a rigid one: (mu (J^2 - 1) + lambda ln J) / J, Poisson's ratio 0, with mu = E / 2."""
    path = tmp_path / "case.feb"
    path.write_text(FEB)
    moved = "".join(f"{i} 0 0 {-0.3 * min(NODES[i - 1][2], 1)}\n" for i in range(1, 17))
    (tmp_path / "moved.txt").write_text("*Step  = 1\n*Time  = 2\n*Data  = ux;uy;uz\n" + moved)
    found = febio.outcome(path, 30.0)
    assert found.status == "solved"
    assert float(found.force.split(",")[2]) == pytest.approx(50.0 * (0.7**2 - 1.0) / 0.7, rel=1e-4)  # as printed
    assert found.error < 1e-9


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("neo-Hookean", "Ogden", "material Ogden"),
        ('<Module type="solid"/>', '<Module type="biphasic"/>', "module biphasic"),
        ('type="hex8" name="low"', 'type="pyra5" name="low"', "elements pyra5"),
        ("LINEAR", "SMOOTH", "load controller 1"),
        ('version="4.0"', 'version="2.5"', "version 2.5"),
        ("</febio_spec>", "", "no XML"),
    ],
)
def test_what_is_not_read_of_febio(old: str, new: str, says: str, tmp_path: Path) -> None:
    (tmp_path / "case.feb").write_text(FEB.replace(old, new))
    with pytest.raises(NotReadable, match=says):
        read_model(tmp_path / "case.feb")
