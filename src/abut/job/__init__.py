"""The job file: TOML in, a checked model out."""

from abut.job.load import Job, load_job
from abut.job.schema import json_schema

__all__ = ["Job", "json_schema", "load_job"]
