"""The hospital as files describe it: places, people, things, walls, maps, zones."""
