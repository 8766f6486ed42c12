"""STEP files (AP214) as other CAD programs write them: an assembly of boxes, each a product of its own, with colours."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import product

FACES = (  # corners of a box by their bits, counter-clockwise from outside; outward normal
    ((0, 2, 6, 4), (-1.0, 0.0, 0.0)), ((1, 5, 7, 3), (1.0, 0.0, 0.0)), ((0, 4, 5, 1), (0.0, -1.0, 0.0)),
    ((2, 3, 7, 6), (0.0, 1.0, 0.0)), ((0, 1, 3, 2), (0.0, 0.0, -1.0)), ((4, 6, 7, 5), (0.0, 0.0, 1.0)),
)  # fmt: skip


@dataclass(frozen=True)
class Box:
    """product: its name as the file has it; solid: that of the solid; size, place: length."""

    product: str
    solid: str
    size: tuple[float, float, float]
    place: tuple[float, float, float]


@dataclass
class Writer:
    lines: list[str] = field(default_factory=list)

    def add(self, text: str) -> str:
        """One entity; returns how others refer to it."""
        self.lines.append(f"#{len(self.lines) + 1} = {text};")
        return f"#{len(self.lines)}"


def numbers(values: Sequence[float]) -> str:
    return "(" + ",".join(f"{value:.6E}" for value in values) + ")"


def assembly(boxes: Sequence[Box], name: str = "Assembly") -> str:
    """The text of a file."""
    to = Writer()
    context = _context(to)
    application = to.add("APPLICATION_CONTEXT('core data for automotive mechanical design processes')")
    to.add(f"APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,{application})")
    whole, shape = _product(to, name, application)
    origin = _axes(to, (0.0, 0.0, 0.0))
    placed = [_axes(to, box.place) for box in boxes]
    root = to.add(f"SHAPE_REPRESENTATION('',({','.join([origin, *placed])}),{context})")
    to.add(f"SHAPE_DEFINITION_REPRESENTATION({shape},{root})")
    styled = []
    for k, (box, place) in enumerate(zip(boxes, placed)):
        own, of = _product(to, box.product, application)
        solid, at = _solid(to, box), _axes(to, (0.0, 0.0, 0.0))
        part = to.add(f"ADVANCED_BREP_SHAPE_REPRESENTATION('',({at},{solid}),{context})")
        to.add(f"SHAPE_DEFINITION_REPRESENTATION({of},{part})")
        used = to.add(f"NEXT_ASSEMBLY_USAGE_OCCURRENCE('{k + 1}','{box.product}','',{whole},{own},$)")
        moved = to.add(f"ITEM_DEFINED_TRANSFORMATION('','',{at},{place})")
        related = to.add(
            f"( REPRESENTATION_RELATIONSHIP('','',{part},{root}) REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION({moved}) "
            "SHAPE_REPRESENTATION_RELATIONSHIP() )"
        )
        occurrence = to.add(f"PRODUCT_DEFINITION_SHAPE('Placement','Placement of an item',{used})")
        to.add(f"CONTEXT_DEPENDENT_SHAPE_REPRESENTATION({related},{occurrence})")
        styled.append(_coloured(to, solid, k))
    to.add(f"MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',({','.join(styled)}),{context})")
    head = (
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('CAD Model'),'2;1');\n"
        f"FILE_NAME('{name}.step','2026-01-01T00:00:00',('Author'),(''),'CAD','CAD','Unknown');\n"
        "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));\nENDSEC;\nDATA;\n"
    )
    return head + "\n".join(to.lines) + "\nENDSEC;\nEND-ISO-10303-21;\n"


def _context(to: Writer) -> str:
    length = to.add("( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) )")
    angle = to.add("( NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.) )")
    solid = to.add("( NAMED_UNIT(*) SI_UNIT($,.STERADIAN.) SOLID_ANGLE_UNIT() )")
    near = to.add(
        f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-07),{length},'distance_accuracy_value','confusion accuracy')"
    )
    return to.add(
        f"( GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({near})) "
        f"GLOBAL_UNIT_ASSIGNED_CONTEXT(({length},{angle},{solid})) REPRESENTATION_CONTEXT('Context #1','3D Context') )"
    )


def _product(to: Writer, name: str, application: str) -> tuple[str, str]:
    """Definition of a product, and of its shape."""
    of = to.add(f"PRODUCT_CONTEXT('',{application},'mechanical')")
    made = to.add(f"PRODUCT('{name}','{name}','',({of}))")
    to.add(f"PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,({made}))")
    formation = to.add(f"PRODUCT_DEFINITION_FORMATION('','',{made})")
    stage = to.add(f"PRODUCT_DEFINITION_CONTEXT('part definition',{application},'design')")
    definition = to.add(f"PRODUCT_DEFINITION('design','',{formation},{stage})")
    return definition, to.add(f"PRODUCT_DEFINITION_SHAPE('','',{definition})")


def _point(to: Writer, at: Sequence[float]) -> str:
    return to.add(f"CARTESIAN_POINT('',{numbers(at)})")


def _direction(to: Writer, along: Sequence[float]) -> str:
    return to.add(f"DIRECTION('',{numbers(along)})")


def _axes(to: Writer, at: Sequence[float], normal: Sequence[float] = (0.0, 0.0, 1.0)) -> str:
    across = (0.0, 1.0, 0.0) if abs(normal[0]) > 0.5 else (1.0, 0.0, 0.0)
    return to.add(f"AXIS2_PLACEMENT_3D('',{_point(to, at)},{_direction(to, normal)},{_direction(to, across)})")


def _solid(to: Writer, box: Box) -> str:
    at = [tuple(bit * size for bit, size in zip(bits[::-1], box.size)) for bits in product((0.0, 1.0), repeat=3)]
    corners = [to.add(f"VERTEX_POINT('',{_point(to, point)})") for point in at]
    edges: dict[tuple[int, int], str] = {}
    faces = []
    for nodes, normal in FACES:
        loop = []
        for a, b in zip(nodes, (*nodes[1:], nodes[0])):
            first, last = min(a, b), max(a, b)
            if (first, last) not in edges:
                way = [q - p for p, q in zip(at[first], at[last])]
                length = sum(map(abs, way))
                vector = to.add(f"VECTOR('',{_direction(to, [w / length for w in way])},1.)")
                line = to.add(f"LINE('',{_point(to, at[first])},{vector})")
                edges[first, last] = to.add(f"EDGE_CURVE('',{corners[first]},{corners[last]},{line},.T.)")
            loop.append(to.add(f"ORIENTED_EDGE('',*,*,{edges[first, last]},.{'T' if a < b else 'F'}.)"))
        edge_loop = to.add(f"EDGE_LOOP('',({','.join(loop)}))")
        bound = to.add(f"FACE_BOUND('',{edge_loop},.T.)")
        plane = to.add(f"PLANE('',{_axes(to, at[nodes[0]], normal)})")
        faces.append(to.add(f"ADVANCED_FACE('',({bound}),{plane},.T.)"))
    shell = to.add(f"CLOSED_SHELL('',({','.join(faces)}))")
    return to.add(f"MANIFOLD_SOLID_BREP('{box.solid}',{shell})")


def _coloured(to: Writer, solid: str, k: int) -> str:
    colour = to.add(f"COLOUR_RGB('',{0.2 + 0.3 * k:.2f},0.5,0.5)")
    fill = to.add(f"FILL_AREA_STYLE_COLOUR('',{colour})")
    area = to.add(f"FILL_AREA_STYLE('',({fill}))")
    surface = to.add(f"SURFACE_STYLE_FILL_AREA({area})")
    side = to.add(f"SURFACE_SIDE_STYLE('',({surface}))")
    usage = to.add(f"SURFACE_STYLE_USAGE(.BOTH.,{side})")
    style = to.add(f"PRESENTATION_STYLE_ASSIGNMENT(({usage}))")
    return to.add(f"STYLED_ITEM('color',({style}),{solid})")
