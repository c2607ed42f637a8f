"""The OpenStreetMap importer."""
