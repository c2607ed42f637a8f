"""Real places: OpenStreetMap files become worlds.

`reasoned_explorer.world.osm.importer.import_osm` is the door; nothing heavy loads before it is asked for.
"""
