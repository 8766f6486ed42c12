"""From the parts of a CAD file to meshes and a job file to start from, by the program Gmsh."""

from abut.parts.assembly import Meshed, mesh_parts
from abut.parts.scripts import Sizes
from abut.parts.starting_job import StartingJob, starting_job

__all__ = ["Meshed", "Sizes", "StartingJob", "mesh_parts", "starting_job"]
