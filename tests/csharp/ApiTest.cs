// SPDX-License-Identifier: MIT
// ApiTest.exe ASSET.sphc PALETTES: what the classes promise. Prints what fails.
using System;
using System.IO;
using System.Linq;
using System.Threading;
using Spherechain;

public static class ApiTest
{
    const MatrixLayout kColumns = MatrixLayout.Columns4x4;
    static readonly Query all = new Query { Classes = Query.AllClasses };
    static float[] deepest;
    static int checks, failures;
    static ResponseFrame anyFrame;

    static void Check(bool holds, string what)
    {
        ++checks;
        if (holds) return;
        Interlocked.Increment(ref failures);
        Console.WriteLine("FAILED: " + what);
    }

    static void Refused(string what, Code code, string field, string text, Action action)
    {
        try
        {
            action();
            Check(false, what + " is refused");
        }
        catch (SpherechainException error)
        {
            Check(error.Code == code && error.FieldName == field && error.Message.Contains(text),
                  string.Format("{0}: {1}, {2}, \"{3}\"", what, error.Code, error.FieldName, error.Message));
        }
    }

    // The palette of the frame with most faults.
    static float[] Deepest(Model model, Palettes clip)
    {
        using (Body body = new Body(model))
        {
            return clip.Frames.Where((p, i) => i % 6 == 0).OrderByDescending(palette =>
            {
                body.SetPose(palette, kColumns);
                return body.Penetrations().Count;
            }).First();
        }
    }

    static T[] Listed<T>(Results<T> results) where T : struct { return results.Items.Take(results.Count).ToArray(); }

    static void ModelIsRead(byte[] file)
    {
        using (Model model = new Model(file))
        {
            Check(model.SphereCount > 50 && model.BoneCount > 10 && model.PartCount > 10 && model.TriangleCount > 1000, "counts");
            Check(model.PartNames.Contains("left hand") && model.PartNames.Contains("head"), "names of parts");
            Check(model.RegionNames.Length == model.RegionCount && model.RegionNames[0].Length > 0, "names of regions");
            int hand = Array.IndexOf(model.PartNames, "left hand");
            Check(model.PartSide(hand) == Native.SideLeft && model.PartBone(hand) >= 0, "the left hand");
            Check(model.PartNames[model.PartParent(hand)] == "left forearm", "the hand hangs on the forearm");
            Check(model.PartJoint((uint)hand) == model.PartBone(hand), "without joints they are the bones");
            Check(model.PartName((uint)hand) == "left hand" && model.PartName(Native.Floor) == null, "a name");
            Check(model.RestSphere(3).Radius > 0 && model.RestSphere(3).Region < 100, "a sphere at rest");
            Triangle owner = Enumerable.Range(0, model.TriangleCount).Select(t => model.Triangle((uint)t)).First(t => t.Part == hand);
            Check(model.RestSphere((int)owner.Sphere).Region == owner.Region, "a triangle's sphere and region");
            Check(model.Triangle(uint.MaxValue).Part == Native.NoPart, "no triangle");
            Check(model.Writer.StartsWith("spherechain ") && model.SourceSha256.Length == 64 && model.Settings.StartsWith("{"), "texts");
            Check(model.Height > 0 && model.MetresPerUnit > 0 && Math.Abs(model.Up.Y) > 0.9f, "axes");
            Check(Math.Abs(model.Millimetres(model.Height) - 1000 * model.Height * model.MetresPerUnit) < 0.01f, "millimetres");
            float[] bind = new float[12];
            model.InverseBind(model.PartBone(hand), bind);
            Check(bind.Any(x => x != 0), "an inverse bind matrix");
            Refused("part -1", Code.BadValue, "index", "-1 is none of", () => model.PartBone(-1));
            Refused("no part", Code.BadValue, "index", "is none of", () => model.PartSet(0, model.PartCount));
            Refused("a short matrix", Code.TooSmall, "output", "12 floats", () => model.InverseBind(0, bind, 1));
        }
        Model closed = new Model(file);
        Body body = new Body(closed);
        closed.Dispose();
        closed.Dispose();
        Refused("a disposed model", Code.NotOpen, "asset", "disposed", () => closed.PartSide(0));
        Refused("its body", Code.NotOpen, "asset", "disposed", () => body.SetPose(deepest, kColumns));
        body.Dispose();
        Refused("no file", Code.Null, "data", "null", () => new Model((byte[])null));
        Refused("garbage", Code.NotAnAsset, "data", "", () => new Model(new byte[200]));
        Refused("an empty file", Code.NotAnAsset, "data", "", () => new Model(new byte[0]));
        Refused("half a file", Code.Corrupt, "data", "", () => new Model(file.Take(file.Length / 2).ToArray()));
    }

    static void WrongArgumentsAreRefused(byte[] file, Palettes clip)
    {
        string[] others = clip.Joints.ToArray();
        int moved = Array.IndexOf(others, "left_elbow");
        others[moved] = "left_elbow_2";
        Refused("another name", Code.NoSuchBone, "joints", "left_elbow", () => new Model(file, others, clip.InverseBinds, kColumns));
        others[moved] = null;
        Refused("no name", Code.Null, "joints", "joint " + moved, () => new Model(file, others));
        Refused("no joints", Code.NoSuchBone, "joints", "", () => new Model(file, new string[0]));
        float[] binds = clip.InverseBinds.ToArray();
        binds[16 * moved + 12] += 100;
        Refused("another rest pose", Code.OtherBind, "joints", "left_elbow", () => new Model(file, clip.Joints, binds, kColumns));
        Refused("few matrices", Code.TooSmall, "joints", "fewer", () => new Model(file, clip.Joints, new float[16], kColumns));
        Refused("no layout", Code.BadValue, "pose.bone_layout", "MatrixLayout", () => new Model(file, clip.Joints, binds));

        using (Model model = new Model(file, clip.Joints, clip.InverseBinds, kColumns))
        {
            model.CheckRest(clip.Rest, kColumns);
            Refused("a pose as rest", Code.OtherBind, "pose.bones", "", () => model.CheckRest(deepest, kColumns));
            Body body = new Body(model);
            Refused("no pose", Code.NotOpen, "bodies", "SetPose", () => body.Contacts());
            Refused("no palette", Code.Null, "pose.bones", "null", () => body.SetPose(null, kColumns));
            Refused("a short palette", Code.TooSmall, "pose.bone_count", "small", () => body.SetPose(new float[32], kColumns));
            Refused("no layout", Code.BadValue, "pose.bone_layout", "", () => body.SetPose(clip.Rest, MatrixLayout.LayoutUnset));
            Refused("few vertices", Code.TooSmall, "pose.vertex_count", "fewer",
                    () => body.SetPose(deepest, kColumns, vertices: new float[30]));
            Refused("no rotation", Code.BadValue, "transform", "", () => body.SetPose(deepest, kColumns, new JointTransform()));
            Refused("still no pose", Code.NotOpen, "bodies", "SetPose", () => body.Penetrations());
            body.SetPose(deepest, kColumns);
            Refused("no way up", Code.BadValue, "floor", "", () => body.Below(new Ground()));
            Refused("itself", Code.BadValue, "bodies", "another", () => body.Contacts(body));
            Refused("no other", Code.Null, "bodies", "null", () => body.Contacts(null));
            Refused("few parts", Code.TooSmall, "ignored_parts", "PartSet", () => body.Contacts(new Query { IgnoredParts = new ulong[0] }));
            Refused("another rule", Code.BadValue, "rule", "", () => body.Penetrations(new Query { Rule = new Rule() }));
            Refused("steps unasked for", Code.TooSmall, "bodies", "findsSteps", () => { body.SetPose(deepest, kColumns); body.Steps(); });
            Check(body.Contacts().Parts.Count > 0 && body.Contacts().Parts[0].TrianglePairs > 0, "contacts after refusals");
            body.Dispose();
            body.Dispose();
            Refused("a disposed body", Code.NotOpen, "bodies", "disposed", () => body.Contacts());
            using (Body other = new Body(model))
            {
                other.SetPose(deepest, kColumns);
                Refused("as the other", Code.NotOpen, "bodies", "disposed", () => other.Contacts(body));
            }
        }
    }

    // By rows, in the asset's own order, and as vertices: the same answers.
    static void PosesAgree(byte[] file, Model model, Palettes clip)
    {
        using (Model unbound = new Model(file))
        using (Body body = new Body(model))
        using (Body own = new Body(unbound))
        {
            float[] rows = new float[deepest.Length / 16 * 12];
            for (int i = 0; i < rows.Length; ++i) rows[i] = deepest[i / 12 * 16 + i % 4 * 4 + i % 12 / 4];
            body.SetPose(deepest, kColumns);
            Penetration[] expected = Listed(body.Penetrations(all));
            Sphere[] spheres = Listed(body.SpherePairs().Spheres);
            body.SetPose(rows, MatrixLayout.Rows3x4);
            Check(expected.Length > 0 && expected.SequenceEqual(Listed(body.Penetrations(all))), "rows: the same bits");

            string[] names = model.BoneNames;
            float[] ordered = new float[12 * names.Length];
            for (int b = 0; b < names.Length; ++b)
            {
                int joint = Array.IndexOf(clip.Joints, names[b]);
                for (int k = 0; k < 12; ++k) ordered[12 * b + k] = joint < 0 ? (k % 5 == 0 ? 1 : 0) : rows[12 * joint + k];
            }
            own.SetPose(ordered, MatrixLayout.Rows3x4);
            Check(spheres.Length == model.SphereCount && spheres.SequenceEqual(Listed(own.SpherePairs().Spheres)), "the asset's order");
            unsafe
            {
                fixed (float* first = ordered)
                {
                    Native.Pose pose = new Native.Pose { Bones = first, BoneLayout = MatrixLayout.Rows3x4, BoneStride = new UIntPtr(48) };
                    pose.BoneCount = new UIntPtr((uint)names.Length);
                    own.SetPose(pose);
                    Check(spheres.SequenceEqual(Listed(own.SpherePairs().Spheres)), "from memory");
                }
            }
            // Vertices are copied: what is done to the array later is not seen.
            Vec3 low, high;
            float[] vertices = new float[3 * model.VertexCount];
            for (int frame = 0; frame < 3; ++frame)
            {
                for (int i = 0; i < vertices.Length; ++i) vertices[i] = i == 0 ? 5 + frame : 0;
                own.SetPose(null, MatrixLayout.LayoutUnset, vertices: vertices);
                vertices[0] = 100;
                own.Bounds(out low, out high);
                Check(low.X == 0 && (high.X == 5 + frame || high.X == 0), "a box around vertices: " + high.X);
            }
        }
    }

    static void QuestionsAreAnswered(Model model, Palettes clip)
    {
        int pairs = 0, faults = 0;
        bool hasVolume = false, isHidden = false;
        using (Body body = new Body(model, findsSteps: true))
        using (Body narrow = new Body(model, maxPenetrations: 1))
        {
            Query full = new Query { Scope = Scope.All, Full = true, Classes = Query.AllClasses };
            IgnoredPairs nothing = new IgnoredPairs(model);
            for (int part = 0; part < model.PartCount; ++part)
            {
                for (int other = 0; other <= part; ++other) nothing.IgnoreParts(part, other, true);
            }
            Refused("no sphere", Code.BadValue, "index", "", () => nothing.IgnorePair(0, 100000, true));
            Query limited = new Query { Limit = 1 }, filtered = new Query { IgnoredPairs = nothing }, rigid = new Query { Rule = Native.sc_default_rule() };
            for (int frame = 0; frame < clip.Frames.Length; frame += 9)
            {
                body.SetPose(clip.Frames[frame], kColumns);
                narrow.SetPose(clip.Frames[frame], kColumns);
                SpherePairs spheres = body.SpherePairs();
                pairs += spheres.Pairs.Count;
                for (int i = 1; i < spheres.Pairs.Count; ++i) Check(spheres.Pairs[i - 1].A <= spheres.Pairs[i].A, "pairs are sorted");
                Check(body.SpherePairs(filtered).Pairs.Count == 0 && body.Contacts(filtered).Parts.Count == 0, "all pairs are ignored");
                Check(body.Contacts().Triangles.Count == 0, "quick: parts alone");
                Contacts contacts = body.Contacts(new Query { Full = true });
                Check(contacts.Triangles.Count == contacts.Parts.Items.Take(contacts.Parts.Count).Sum(c => c.TrianglePairs), "triangles");
                foreach (PartContact contact in contacts) Check(contact.PartA <= contact.PartB && contact.TrianglePairs > 0, "parts");
                Penetration[] found = Listed(body.Penetrations());
                faults += found.Length;
                Check(found.All(p => p.Kind >= PenetrationClass.DeepFold && p.Measures.Depth > 0), "faults alone");
                Check(found.All(p => p.Joint == model.PartJoint(p.Part) && clip.Joints[p.Joint].Length > 0), "joints");
                Check(found.SequenceEqual(Listed(body.Penetrations(rigid))), "the default rule");
                Check(Listed(body.Penetrations(all)).Count(Meets) == contacts.Parts.Count, "a penetration for each two parts in contact");
                Results<Penetration> worst = body.Penetrations(limited);
                Check(worst.Total == found.Length && Listed(worst).SequenceEqual(found.Take(1)), "the worst one");
                Check(Listed(narrow.Penetrations()).SequenceEqual(found.Take(1)), "the worst one that there is room for");
                int listed = 0;
                foreach (Penetration one in body.Penetrations()) Check(one.Equals(found[listed++]), "foreach");
                Check(listed == found.Length, "foreach lists all");
                if (frame % 45 > 0) continue;
                found = Listed(body.Penetrations(full));
                hasVolume |= found.Any(p => p.Measures.Volume > 0);
                isHidden |= found.Any(p => p.Measures.Visible < 1);
            }
            Check(pairs > 20 && faults > 5 && hasVolume && isHidden,
                  string.Format("{0} pairs, {1} faults, volumes {2}, hidden {3}", pairs, faults, hasVolume, isHidden));

            // The way out of the same pose stays, whatever it was.
            body.SetPose(deepest, kColumns);
            Results<Penetration> kept = new Results<Penetration>();
            kept.CopyFrom(body.Penetrations());
            Check(Listed(kept).SequenceEqual(Listed(body.Penetrations(new Query { Previous = kept }))), "history");

            body.SetPose(clip.Rest, kColumns);
            body.SetPose(deepest, kColumns);
            Results<StepContact> steps = body.Steps();
            Check(steps.Count > 0 && Listed(steps).Any(c => c.AtStart == 0 && c.Begin > 0 && c.Begin < 1), "steps");

            // The ground at the height of the knees.
            Ground ground = new Ground { Up = model.Up, Height = model.Origin.Y + 0.25f * model.Height };
            Penetration[] below = Listed(body.Below(ground, all));
            Check(below.Length > 0 && below.Length < model.PartCount && below[0].Other == Native.Floor, "the ground: " + below.Length);
            Check(below.Any(p => model.PartName(p.Part).Contains("foot")), "feet are below");
        }
    }

    static JointTransform Beside(Model model, float heights)
    {
        JointTransform place = new JointTransform { Rotation3 = 1 };
        place.Scale.X = place.Scale.Y = place.Scale.Z = 1;
        place.Translation.X = heights * model.Height;
        return place;
    }

    // Does skin cross skin? A part that is wholly inside another meets no skin.
    static bool Meets(Penetration of)
    {
        return of.Kind != PenetrationClass.Inside || of.Measures.ContourLength > 0;
    }

    static void TwoBodiesMeet(Model model)
    {
        using (Body a = new Body(model, model, true))
        using (Body b = new Body(model))
        {
            a.SetPose(deepest, kColumns);
            Refused("no pose", Code.NotOpen, "bodies", "SetPose", () => a.Contacts(b));
            Query full = new Query { Full = true };
            foreach (float distance in new[] { 0.1f, 10 })
            {
                b.SetPose(deepest, kColumns, Beside(model, distance));
                Contacts contacts = a.Contacts(b, full);
                int parts = contacts.Parts.Count, triangles = contacts.Triangles.Count;
                Check(parts > 0 == distance < 1, "contacts at " + distance);
                contacts = b.Contacts(a, full);
                Check(contacts.Parts.Count == parts && contacts.Triangles.Count == triangles, "contacts the other way round");
                Check(Listed(a.Penetrations(b, all)).Count(Meets) == Math.Min(parts, 128), "measures at " + distance);
                Check(Listed(a.Penetrations(b, all)).All(p => p.Measures.Depth > 0), "a depth");
            }
            a.SetPose(deepest, kColumns);
            b.SetPose(deepest, kColumns, Beside(model, 0.1f));
            Check(a.Steps(b).Count > 0, "on the way");
            ulong[] parts_of_a = model.PartSet(Enumerable.Range(0, model.PartCount).ToArray());
            Check(a.Contacts(b, new Query { IgnoredParts = parts_of_a }).Parts.Count == 0, "ignored parts meet nothing");
            Check(b.Contacts(a, new Query { IgnoredPartsOfOther = parts_of_a }).Parts.Count == 0, "nor the other way round");
            PartContact first = a.Contacts(b, full).Parts[0];
            ulong[] first_alone = model.PairSet(model, new Pair { A = first.PartA, B = first.PartB });
            Check(a.Contacts(b, new Query { PartPairs = first_alone }).Parts.Count == 1, "one pair of parts alone");
            Refused("few pairs", Code.TooSmall, "part_pairs", "PairSet", () => a.Contacts(b, new Query { PartPairs = new ulong[0] }));
            Check(a.Penetrations(b).Count > 0 && a.Penetrations().Count > 0 && a.Penetrations(b) != a.Penetrations(),
                  "lists of their own: " + a.Penetrations(b).Count + ", " + a.Penetrations().Count);
        }
    }

    static void FramesAllocateNothing(Model model, Palettes clip)
    {
        using (Body body = new Body(model, findsSteps: true))
        using (Body other = new Body(model))
        {
            JointTransform beside = Beside(model, 0.3f);
            Query query = new Query { Full = true, IgnoredPairs = new IgnoredPairs(model) };
            Ground ground = new Ground { Up = model.Up, Height = model.Origin.Y };
            other.SetPose(clip.Frames[0], kColumns);
            body.SetPose(clip.Frames[0], kColumns);
            long before = 0;
            for (int round = 0; round < 2; ++round)  // the first makes lists as large as they get, and compiles
            {
                before = GC.GetAllocatedBytesForCurrentThread();
                for (int frame = 0; frame < clip.Frames.Length; frame += 18)
                {
                    body.SetPose(clip.Frames[frame], kColumns);
                    other.SetPose(clip.Frames[frame], kColumns, beside);
                    query.Previous = body.Penetrations(query);
                    float sum = 0;
                    foreach (Penetration found in query.Previous) sum += found.Distance;
                    body.Penetrations(other);
                    body.Contacts(query);
                    body.Contacts(other);
                    body.SpherePairs();
                    body.Below(ground);
                    if (frame == 36) body.Steps(other);
                }
            }
            long allocated = GC.GetAllocatedBytesForCurrentThread() - before;
            Check(allocated == 0, allocated + " bytes are allocated in frames");
            byte[] proof = new byte[100000];
            Check(GC.GetAllocatedBytesForCurrentThread() - before >= proof.Length, "what is allocated is counted");
        }
    }

    // Each with a body of its own, and one that both meet.
    static void ThreadsShareAModel(Model model, Palettes clip)
    {
        using (Body met = new Body(model))
        {
            met.SetPose(deepest, kColumns, Beside(model, 0.2f));
            int[][] counts = new int[2][];
            Thread[] threads = new Thread[2];
            for (int t = 0; t < threads.Length; ++t)
            {
                int own = t;
                threads[t] = new Thread(() =>
                {
                    using (Body body = new Body(model))
                    {
                        counts[own] = clip.Frames.Skip(60).Take(20).Select(palette =>
                        {
                            body.SetPose(palette, kColumns);
                            return body.SpherePairs().Pairs.Count + 1000 * body.Contacts().Parts.Count + 10000 * body.Contacts(met).Parts.Count;
                        }).ToArray();
                    }
                });
                threads[t].Start();
            }
            foreach (Thread thread in threads) thread.Join();
            Check(counts[0].SequenceEqual(counts[1]) && counts[0].Sum() > 0, "two threads find the same");
        }
    }

    // Two threads do the same: each call either does its work or is refused, and both are seen.
    static void Compete(string what, Action first, Action second)
    {
        int refused = 0, done = 0;
        DateTime end = DateTime.UtcNow.AddSeconds(2);
        Action<Action> work = action =>
        {
            while (Volatile.Read(ref refused) == 0 && DateTime.UtcNow < end)
            {
                try
                {
                    action();
                    Interlocked.Increment(ref done);
                }
                catch (SpherechainException error)
                {
                    Check(error.Code == Code.Aliased && error.Message.Contains("one a thread"), error.Message);
                    Interlocked.Increment(ref refused);
                }
            }
        };
        Thread other = new Thread(() => work(second));
        other.Start();
        work(first);
        other.Join();
        Check(refused > 0 && done > 0, what + ": refused " + refused + ", done " + done);
    }

    static void ABodyIsOneThreads(Model model)
    {
        using (Body body = new Body(model))
        using (Body other = new Body(model))
        {
            body.SetPose(deepest, kColumns);
            other.SetPose(deepest, kColumns);
            Compete("questions", () => body.Contacts(), () => body.Contacts());
            Compete("a new pose of the other", () => body.Contacts(other), () => other.SetPose(deepest, kColumns));
            Check(body.Contacts(other).Parts.Count > 0, "all is unlocked");
            other.SetPose(deepest, kColumns);
        }
    }

    // Dropped without Dispose(): the collector frees them, and not before.
    static void DroppedObjectsAreFreed(byte[] file, Palettes clip)
    {
        for (int i = 0; i < 10; ++i)
        {
            Body body = new Body(new Model(file, clip.Joints));  // the body keeps its model
            body.SetPose(null, MatrixLayout.LayoutUnset, vertices: new float[3 * body.Model.VertexCount]);
            GC.Collect();
            GC.WaitForPendingFinalizers();
            body.SetPose(deepest, kColumns);
            Check(body.Contacts().Parts.Count > 0, "a model outlives its name");
        }
    }

    // Matrices of 16 floats by columns. The inverse is of one that turns, moves and scales all axes alike.
    static float[] Times(float[] a, float[] b)
    {
        float[] product = new float[16];
        for (int i = 0; i < 16; ++i)
        {
            for (int k = 0; k < 4; ++k) product[i] += a[4 * k + i % 4] * b[i / 4 * 4 + k];
        }
        return product;
    }

    static float[] Inverse(float[] m)
    {
        float[] inverse = new float[16];
        float squared = m[0] * m[0] + m[1] * m[1] + m[2] * m[2];
        for (int i = 0; i < 3; ++i)
        {
            for (int k = 0; k < 3; ++k)
            {
                inverse[4 * k + i] = m[4 * i + k] / squared;
                inverse[12 + i] -= m[4 * i + k] * m[12 + k] / squared;
            }
        }
        inverse[15] = 1;
        return inverse;
    }

    static JointTransform Decomposed(float[] m)
    {
        JointTransform t = new JointTransform { Translation = new Vec3 { X = m[12], Y = m[13], Z = m[14] } };
        float scale = (float)Math.Sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]);
        t.Scale = new Vec3 { X = scale, Y = scale, Z = scale };
        // Each row of this symmetric matrix is the quaternion times one of its entries.
        float xx = m[0] / scale, yy = m[5] / scale, zz = m[10] / scale, yz = (m[9] + m[6]) / scale, xz = (m[8] + m[2]) / scale,
              xy = (m[4] + m[1]) / scale, xw = (m[6] - m[9]) / scale, yw = (m[8] - m[2]) / scale, zw = (m[1] - m[4]) / scale;
        float[][] rows =
        {
            new[] { 1 + xx - yy - zz, xy, xz, xw }, new[] { xy, 1 - xx + yy - zz, yz, yw },
            new[] { xz, yz, 1 - xx - yy + zz, zw }, new[] { xw, yw, zw, 1 + xx + yy + zz },
        };
        float[] q = rows.OrderByDescending(row => row.Sum(entry => entry * entry)).First();
        float size = (float)Math.Sqrt(q.Sum(entry => entry * entry));
        t.Rotation0 = q[0] / size;
        t.Rotation1 = q[1] / size;
        t.Rotation2 = q[2] / size;
        t.Rotation3 = q[3] / size;
        return t;
    }

    // Joints hang on each other as the body parts that they move do.
    static uint[] Parents(Model model, Palettes clip)
    {
        uint[] parents = Enumerable.Repeat(Native.NoJoint, clip.Joints.Length).ToArray();
        for (int part = 0; part < model.PartCount; ++part)
        {
            int above = model.PartParent(part);
            uint joint = model.PartJoint((uint)part), of_above = above < 0 ? Native.NoJoint : model.PartJoint((uint)above);
            if (joint != Native.NoJoint && joint != of_above) parents[joint] = of_above;
        }
        return parents;
    }

    static JointTransform[] Locals(Palettes clip, uint[] parents, int frame)
    {
        float[][] world = parents.Select((_, joint) => Times(clip.Frames[frame].Skip(16 * joint).Take(16).ToArray(),
                                                             Inverse(clip.InverseBinds.Skip(16 * joint).Take(16).ToArray()))).ToArray();
        return world.Select((own, joint) => Decomposed(parents[joint] == Native.NoJoint ? own : Times(Inverse(world[parents[joint]]), own))).ToArray();
    }

    // The same frames through the class and through the C interface: the same bits.
    static unsafe void ResponsesTurnArms(Model model, Palettes clip)
    {
        const float seconds = 1.0f / 30;
        uint[] parents = Parents(model, clip);
        JointTransform[][] frames = Enumerable.Range(24, 11).Select(i => Locals(clip, parents, i)).ToArray();
        using (Body body = new Body(model))
        using (Body raw = new Body(model))
        using (Body other = new Body(model))
        using (Response response = new Response(body, parents))
        {
            other.SetPose(deepest, kColumns, Beside(model, 0.4f));
            IntPtr handle, met = other.Handle;
            fixed (uint* above = parents)
            {
                Native.ResponseDef def = new Native.ResponseDef { Parents = above, JointCount = new UIntPtr((uint)parents.Length) };
                Check(Native.sc_create_response(raw.Handle, &def, &handle).Code == Code.Ok, "a response of the C interface");
            }
            uint planted = 2;
            for (int options = 0; options < 2; ++options)
            {
                int turned = 0, rows = 0;
                ResponseState state = new ResponseState(), copy = new ResponseState();
                ulong[] words = new ulong[Native.ResponseWords];
                for (int i = 0; i + 1 < frames.Length; ++i)
                {
                    JointTransform[] joints = frames[i].ToArray(), expected = frames[i].ToArray(), replayed = frames[i].ToArray();
                    JointTransform place = Beside(model, 0.1f);
                    Ground ground = new Ground { Up = model.Up, Height = model.Origin.Y + 0.5f * model.Height };
                    Native.Ground plane = new Native.Ground { Up = ground.Up, Height = ground.Height };
                    ResponseFrame frame = new ResponseFrame { Seconds = seconds };
                    Native.ResponseFrame f = new Native.ResponseFrame { Seconds = seconds };
                    if (options == 1)
                    {
                        frame = new ResponseFrame
                        {
                            Seconds = seconds, Place = place, Weakness = 0.25f, Rounds = 2, Ahead = frames[i + 1], AheadFrames = 1,
                            Others = new[] { other }, Ground = ground, Planted = new uint[] { 2 },
                        };
                        f = new Native.ResponseFrame
                        {
                            Seconds = seconds, Place = &place, Weakness = 0.25f, Rounds = 2, AheadFrames = 1, Others = &met,
                            OtherCount = new UIntPtr(1), Ground = &plane, Planted = &planted, PlantedCount = new UIntPtr(1),
                        };
                    }
                    ResponseFrame again = frame;
                    copy.CopyFrom(state);
                    response.Respond(state, joints, ref frame);
                    fixed (JointTransform* own = expected, ahead = frames[i + 1])
                    fixed (ulong* memory = words)
                    {
                        f.Joints = own;
                        f.Ahead = options == 1 ? ahead : null;
                        Check(Native.sc_respond(handle, memory, &f).Code == Code.Ok, "a frame of the C interface");
                    }
                    Check(joints.SequenceEqual(expected) && state.Words.SequenceEqual(words), "joints and state of frame " + i);
                    Check(frame.Turned == f.Turned && frame.AtBudget == f.AtBudget && frame.Remaining == f.Remaining, "answers of frame " + i);
                    Check(response.Rows.Count == (int)f.RowCount, "rows of frame " + i);
                    for (int k = 0; k < response.Rows.Count; ++k) Check(response.Rows[k].Equals(f.Rows[k]), "row " + k);
                    Check(frame.Turned == 0 == joints.SequenceEqual(frames[i]), "joints are turned, or stay");
                    response.Respond(copy, replayed, ref again);
                    Check(replayed.SequenceEqual(expected) && copy.Words.SequenceEqual(words), "a copied state replays frame " + i);
                    turned += frame.Turned;
                    rows += response.Rows.Count;
                }
                Check(turned > 20 && rows > 20, string.Format("{0} turned, {1} rows", turned, rows));
                state.Reset();
                Check(state.Words.All(word => word == 0), "a reset state");
            }
            Native.sc_destroy_response(handle);
            other.SetPose(deepest, kColumns, Beside(model, 10));
            ResponsesAllocateNothing(response, frames, other);
        }
    }

    static void ResponsesAllocateNothing(Response response, JointTransform[][] frames, Body other)
    {
        ResponseState state = new ResponseState();
        ResponseFrame frame = new ResponseFrame { Seconds = 1.0f / 30, Others = new[] { other }, Ground = new Ground { Up = response.Body.Model.Up } };
        JointTransform[] joints = new JointTransform[frames[0].Length];
        long before = 0;
        for (int round = 0; round < 2; ++round)
        {
            state.Reset();
            before = GC.GetAllocatedBytesForCurrentThread();
            foreach (JointTransform[] animated in frames)
            {
                animated.CopyTo(joints, 0);
                response.Respond(state, joints, ref frame);
                float sum = 0;
                foreach (ContactRow row in response.Rows) sum += row.Gap;
            }
        }
        long allocated = GC.GetAllocatedBytesForCurrentThread() - before;
        Check(allocated == 0, allocated + " bytes are allocated in frames of a response");
    }

    static void WrongResponsesAreRefused(Model model, Palettes clip)
    {
        uint[] parents = Parents(model, clip), circle = parents.ToArray();
        int count = parents.Length;
        circle[0] = 1;
        circle[1] = 0;
        JointTransform[] joints = Locals(clip, parents, 0), given = joints.ToArray(), broken = joints.ToArray();
        broken[2].Rotation1 = float.NaN;
        Body body = new Body(model), other = new Body(model), unposed = new Body(model);
        other.SetPose(deepest, kColumns, Beside(model, 10));
        Refused("no body", Code.Null, "bodies", "null", () => new Response(null, parents));
        Refused("no parents", Code.Null, "parents", "null", () => new Response(body, null));
        Refused("no joints", Code.TooSmall, "joints", "", () => new Response(body, new uint[0]));
        Refused("few joints", Code.TooSmall, "joints", "", () => new Response(body, parents.Take(2).ToArray()));
        Refused("a circle", Code.BadValue, "parents", "", () => new Response(body, circle));
        Refused("few mobilities", Code.TooSmall, "joints", "mobilities", () => new Response(body, parents, new float[1]));
        Refused("a mobility of 2", Code.BadValue, "joints", "", () => new Response(body, parents, Enumerable.Repeat(2.0f, count).ToArray()));
        Refused("few budgets", Code.TooSmall, "joints", "budgets", () => new Response(body, parents, budget: new float[1]));
        Refused("few pairs", Code.TooSmall, "part_pairs", "PairSet", () => new Response(body, parents, partPairs: new ulong[0]));
        Refused("another rule", Code.BadValue, "rule", "", () => new Response(body, parents, rule: new Rule()));
        Response response = new Response(body, parents);
        ResponseState state = new ResponseState();
        Action<ResponseFrame, JointTransform[]> respond = (frame, own) => response.Respond(state, own, ref frame);
        Refused("no state", Code.Null, "output", "null", () => { ResponseFrame frame = new ResponseFrame(); response.Respond(null, given, ref frame); });
        Refused("no joints", Code.Null, "joints", "null", () => respond(new ResponseFrame(), null));
        Refused("few joints", Code.TooSmall, "joints", "fewer", () => respond(new ResponseFrame(), new JointTransform[1]));
        Refused("a NaN", Code.BadValue, "transform", "", () => respond(new ResponseFrame(), broken));
        Refused("endless seconds", Code.BadValue, "query", "", () => respond(new ResponseFrame { Seconds = float.PositiveInfinity }, given));
        Refused("rounds below 0", Code.BadValue, "query", "below 0", () => respond(new ResponseFrame { Rounds = -1 }, given));
        Refused("17 rounds", Code.BadValue, "query", "", () => respond(new ResponseFrame { Rounds = 17 }, given));
        Refused("few joints ahead", Code.TooSmall, "joints", "ahead", () => respond(new ResponseFrame { Ahead = new JointTransform[1], AheadFrames = 1 }, given));
        Refused("nothing ahead", Code.Null, "bodies", "", () => respond(new ResponseFrame { AheadFrames = 1 }, given));
        Refused("no other", Code.Null, "bodies", "null", () => respond(new ResponseFrame { Others = new Body[1] }, given));
        Refused("itself", Code.BadValue, "bodies", "another", () => respond(new ResponseFrame { Others = new[] { body } }, given));
        Refused("nine others", Code.BadValue, "bodies", "8", () => respond(new ResponseFrame { Others = Enumerable.Repeat(other, 9).ToArray() }, given));
        Refused("no pose", Code.NotOpen, "bodies", "", () => respond(new ResponseFrame { Others = new[] { unposed } }, given));
        Refused("no way up", Code.BadValue, "floor", "", () => respond(new ResponseFrame { Ground = new Ground() }, given));
        Check(given.SequenceEqual(joints) && state.Words.All(word => word == 0), "joints and state are as they were");
        respond(new ResponseFrame { Seconds = 0.1f, Others = Enumerable.Repeat(other, 8).ToArray() }, given);
        Compete("frames", () => respond(new ResponseFrame(), joints.ToArray()), () => response.Respond(new ResponseState(), joints.ToArray(), ref anyFrame));
        Compete("a new pose of its body", () => respond(new ResponseFrame(), joints.ToArray()), () => body.SetPose(deepest, kColumns));
        unposed.Dispose();
        Refused("a disposed other", Code.NotOpen, "bodies", "disposed", () => respond(new ResponseFrame { Others = new[] { unposed } }, given));
        body.Dispose();
        Refused("a disposed body", Code.NotOpen, "bodies", "body is disposed", () => respond(new ResponseFrame(), given));
        response.Dispose();
        response.Dispose();
        Refused("a disposed response", Code.NotOpen, "bodies", "response is disposed", () => respond(new ResponseFrame(), given));
        other.Dispose();
        for (int i = 0; i < 5; ++i)  // dropped without Dispose()
        {
            Response dropped = new Response(new Body(model), parents);
            GC.Collect();
            GC.WaitForPendingFinalizers();
            ResponseFrame frame = new ResponseFrame();
            dropped.Respond(state, given, ref frame);
        }
    }

    static void MirrorsAreTheirOwnInverse()
    {
        float[] m = Enumerable.Range(1, 16).Select(x => (float)x).ToArray();
        float[] twice = m.ToArray();
        Mirror.ToSource(twice, 0, Axis.X, 0.5f);
        // Rows of X turned, but where row and column are; the translation twice as long.
        Check(twice.SequenceEqual(new float[] { 1, -2, -3, 4, -5, 6, 7, 8, -9, 10, 11, 12, -26, 28, 30, 16 }), "X: " + string.Join(" ", twice));
        Mirror.ToSource(twice, 0, Axis.X, 2);
        Check(twice.SequenceEqual(m), "and back");
        Mirror.ToSource(twice, 0, Axis.None);
        Check(twice.SequenceEqual(m), "none");
        Vec3 p = Mirror.PointToEngine(new Vec3 { X = 1, Y = 2, Z = 3 }, Axis.Z, 2);
        Check(p.X == 2 && p.Y == 4 && p.Z == -6, "a point");
    }

    public static int Main(string[] arguments)
    {
        byte[] file = File.ReadAllBytes(arguments[0]);
        Palettes clip = new Palettes(arguments[1]);
        using (Model model = new Model(file, clip.Joints, clip.InverseBinds, kColumns))
        {
            deepest = Deepest(model, clip);
            ModelIsRead(file);
            WrongArgumentsAreRefused(file, clip);
            PosesAgree(file, model, clip);
            QuestionsAreAnswered(model, clip);
            TwoBodiesMeet(model);
            FramesAllocateNothing(model, clip);
            ThreadsShareAModel(model, clip);
            ABodyIsOneThreads(model);
            ResponsesTurnArms(model, clip);
            WrongResponsesAreRefused(model, clip);
        }
        DroppedObjectsAreFreed(file, clip);
        MirrorsAreTheirOwnInverse();
        Console.WriteLine("{0} checks, {1} failures", checks, failures);
        return failures == 0 ? 0 : 1;
    }
}
