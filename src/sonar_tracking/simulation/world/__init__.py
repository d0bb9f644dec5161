"""The world of a scenario: own ship and the truth, whatever sensors listen to it."""
